// The times of the images in a video, as FFmpeg reads them.
#pragma once

#include <ffmpeg.hpp>

#include <string>
#include <vector>

/// In seconds, in the order in which they are shown; as many as can be read.
inline std::vector<double> times_in(const std::string& path)
{
    AVFormatContext* file = nullptr;
    ffmpeg::checked(avformat_open_input(&file, ("file:" + path).c_str(), nullptr, nullptr), path);
    std::vector<double> times;
    const ffmpeg::PacketPtr packet(av_packet_alloc());
    while (av_read_frame(file, packet.get()) >= 0) {
        const auto time = packet->pts == AV_NOPTS_VALUE ? packet->dts : packet->pts;  // an AVI has no other
        times.push_back(static_cast<double>(time) * av_q2d(file->streams[packet->stream_index]->time_base));
        av_packet_unref(packet.get());
    }
    avformat_close_input(&file);
    return times;
}
