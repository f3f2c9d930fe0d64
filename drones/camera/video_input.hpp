// Reads and decodes the video of a file, and records what is missing.
#pragma once

#include "ffmpeg_log.hpp"

#include <ffmpeg.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace camera {

/// For one thread.
class VideoInput final : private FfmpegLog {
public:
    /// @throws std::runtime_error  naming the file and what is wrong
    explicit VideoInput(const std::string& path);

    /// The next frame in the order of presentation, valid until the next call; null at the end.
    const AVFrame* next();
    /// The presentation time of that frame, from the start of the stream, if the file has it.
    [[nodiscard]] std::optional<std::chrono::microseconds> time() const;
    /// Of the stream; 0: unknown.
    [[nodiscard]] double fps() const { return fps_; }
    /// Clockwise rotation for display, by the file.
    [[nodiscard]] int quarter_turns() const { return quarter_turns_; }
    /// The number of frames; an estimate if the file has only its duration; 0: unknown.
    [[nodiscard]] std::int64_t frames() const;
    /// After the last frame: what was missing or damaged, as a sentence; empty: nothing was. Only what FFmpeg found
    /// while it read counts, and the number of frames where the file has a table of them: no estimate.
    [[nodiscard]] std::string shortfall() const;

private:
    void damaged_scan() override { scan_damaged_ = true; }
    void demuxer_error(const std::string& text) override { note("FFmpeg: " + text); }

    void open();
    void open_decoder(const AVCodec* codec);
    void feed();
    void refused(int code);
    void note(const std::string& problem);
    [[nodiscard]] bool awaits_first() const { return begins_inside_ && given_ == 0; }
    [[nodiscard]] std::int64_t packets_in_table() const;

    std::string path_;
    ffmpeg::Input input_;
    AVStream* video_ = nullptr;
    ffmpeg::CodecContext decoder_;
    ffmpeg::PacketPtr packet_{av_packet_alloc()};
    ffmpeg::FramePtr frame_{av_frame_alloc()};
    double fps_ = 0;
    int quarter_turns_ = 0;
    bool has_index_ = false;
    bool scan_damaged_ = false;               ///< since the last frame
    bool begins_inside_ = false;              ///< of a stream: with a frame that needs others
    std::int64_t packets_ = 0, refused_ = 0;  ///< read, and of these not decoded
    std::int64_t given_ = 0, damaged_ = 0;    ///< frames
    /// Of the times. In an AVI a frame has only the time of its decoding, which is late by as many frames as wait.
    std::int64_t origin_ = 0;
    std::string problem_;  ///< the first
};

}  // namespace camera
