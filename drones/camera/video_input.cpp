// Decides from FFmpeg's errors, and from tables of frames, whether a file is whole.
#include "video_input.hpp"

#include "video_source.hpp"

extern "C" {
#include <libavutil/display.h>
}

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

namespace camera {
namespace {

constexpr double slowest_fps = 0.001;  ///< a lower rate is not plausible
constexpr AVRational microsecond{1, 1'000'000};
constexpr std::int64_t latest = std::int64_t{1} << 52;  ///< microseconds: no video is 140 years long

/// No other protocol: a path may have a colon, and a playlist may name other addresses.
ffmpeg::Input opened(const std::string& path)
{
    AVFormatContext* context = nullptr;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    const int code =
        avformat_open_input(&context, ("file:" + std::filesystem::absolute(path).string()).c_str(), nullptr, &options);
    av_dict_free(&options);
    ffmpeg::checked(code, "FFmpeg");
    return ffmpeg::Input(context);
}

int turns_of(const AVStream& stream)
{
    const auto* matrix =
        reinterpret_cast<const std::int32_t*>(av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr));
    const double degrees = matrix ? -av_display_rotation_get(matrix) : 0;
    return std::isfinite(degrees) ? (static_cast<int>(std::lround(degrees / 90)) % 4 + 4) % 4 : 0;
}

}  // namespace

VideoInput::VideoInput(const std::string& path) : path_(path)
{
    const FfmpegLogWatch watch(*this);
    try {
        if (std::filesystem::is_empty(path))
            throw std::runtime_error("it is empty");
        open();
    } catch (const std::exception& error) {
        throw std::runtime_error(path
                                 + " is not a video that can be read: " + (problem_.empty() ? error.what() : problem_));
    }
}

void VideoInput::open()
{
    input_ = opened(path_);
    problem_.clear();  // an odd header is ignored if the file can be opened
    const AVCodec* codec = nullptr;
    has_index_ = std::any_of(input_->streams, input_->streams + input_->nb_streams, [](const AVStream* stream) {
        return stream->codecpar->codec_type == AVMEDIA_TYPE_VIDEO && avformat_index_get_entries_count(stream) > 0;
    });
    ffmpeg::checked(avformat_find_stream_info(input_.get(), nullptr), "FFmpeg");
    const int found = av_find_best_stream(input_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
    if (found == AVERROR_STREAM_NOT_FOUND)
        throw std::runtime_error("it contains no video");
    ffmpeg::checked(found, "FFmpeg");
    video_ = input_->streams[found];
    for (unsigned i = 0; i < input_->nb_streams; ++i)
        if (input_->streams[i] != video_)
            input_->streams[i]->discard = AVDISCARD_ALL;
    fps_ = std::max(0.0, av_q2d(av_guess_frame_rate(input_.get(), video_, nullptr)));
    fps_ = std::isfinite(fps_) && fps_ >= slowest_fps ? fps_ : 0;
    quarter_turns_ = turns_of(*video_);
    open_decoder(codec);
}

void VideoInput::open_decoder(const AVCodec* codec)
{
    decoder_.reset(avcodec_alloc_context3(codec));
    ffmpeg::checked(avcodec_parameters_to_context(decoder_.get(), video_->codecpar), "FFmpeg");
    decoder_->pkt_timebase = video_->time_base;
    decoder_->max_pixels = UrlLimits{}.pixels;
    decoder_->thread_count = 0;  // one per core: a file must not be slow
    ffmpeg::checked(avcodec_open2(decoder_.get(), codec, nullptr), "FFmpeg");
}

const AVFrame* VideoInput::next()
{
    for (;;) {
        const int code = avcodec_receive_frame(decoder_.get(), frame_.get());
        if (code == AVERROR_EOF)
            return nullptr;
        if (code == AVERROR(EAGAIN)) {
            feed();
        } else if (code < 0) {
            refused(code);
        } else {
            if (given_++ == 0)
                origin_ = frame_->pts == AV_NOPTS_VALUE ? frame_->best_effort_timestamp : video_->start_time;
            damaged_ += std::exchange(scan_damaged_, false) || frame_->decode_error_flags != 0 ? 1 : 0;
            return frame_.get();
        }
    }
}

/// Passes the next packet of the video to the decoder; at the end, flushes the decoder.
void VideoInput::feed()
{
    const FfmpegLogWatch watch(*this);
    int code = 0;
    do {
        av_packet_unref(packet_.get());
        code = av_read_frame(input_.get(), packet_.get());
    } while (code >= 0 && packet_->stream_index != video_->index);
    if (code < 0) {
        if (code != AVERROR_EOF)
            note("FFmpeg: " + ffmpeg::text_of(code));
        avcodec_send_packet(decoder_.get(), nullptr);
        return;
    }
    if (packets_++ == 0)
        begins_inside_ = (packet_->flags & AV_PKT_FLAG_KEY) == 0;
    if (!awaits_first() && (packet_->flags & AV_PKT_FLAG_CORRUPT) != 0)
        note("a part of it is missing");
    if (packet_->size > 0)  // an empty packet would signal the end
        if (const int refusal = avcodec_send_packet(decoder_.get(), packet_.get()); refusal < 0)
            refused(refusal);
}

/// Packets before the first key frame are not a loss.
void VideoInput::refused(int code)
{
    if (awaits_first())
        return;
    ++refused_;
    note("FFmpeg: " + ffmpeg::text_of(code));
}

void VideoInput::note(const std::string& problem)
{
    if (problem_.empty())
        problem_ = problem;
}

std::optional<std::chrono::microseconds> VideoInput::time() const
{
    const auto stamp = frame_->best_effort_timestamp;
    if (stamp == AV_NOPTS_VALUE)
        return std::nullopt;
    // Checked separately: values of a damaged file may be of any size.
    const auto origin = origin_ == AV_NOPTS_VALUE ? 0 : origin_;
    const auto in_file = av_rescale_q(stamp, video_->time_base, microsecond),
               at_begin = av_rescale_q(origin, video_->time_base, microsecond);
    if (in_file != std::clamp(in_file, -latest, latest) || at_begin != std::clamp(at_begin, -latest, latest))
        return std::nullopt;
    return std::chrono::microseconds(in_file - at_begin);
}

/// MP4, MOV and AVI have an index with an entry for each packet. An AVI whose index is lost, and an MP4 that ends
/// inside it, still have their number of packets in the header; for a GIF, FFmpeg counts them. 0: no table.
std::int64_t VideoInput::packets_in_table() const
{
    const std::string_view format = input_->iformat->name;
    const bool indexed = format.starts_with("mov,") || format == "avi";
    if (indexed && has_index_)
        return avformat_index_get_entries_count(video_);
    return indexed || format == "gif" ? video_->nb_frames : 0;
}

std::int64_t VideoInput::frames() const
{
    if (const auto exact = packets_in_table(); exact > 0)
        return exact;
    const double seconds = static_cast<double>(std::max<std::int64_t>(0, input_->duration)) / AV_TIME_BASE;
    return std::llround(seconds * fps_);
}

std::string VideoInput::shortfall() const
{
    const auto undecoded = given_ == 0 ? packets_ : refused_;
    const auto lacking = undecoded + std::max<std::int64_t>(0, packets_in_table() - packets_);
    if (lacking == 0 && damaged_ == 0 && problem_.empty())
        return "";
    return path_ + ": " + std::to_string(given_) + (lacking > 0 ? " of " + std::to_string(given_ + lacking) : "")
           + (given_ == 1 && lacking == 0 ? " frame" : " frames") + ": the file is damaged or was cut short"
           + (damaged_ > 0 ? "; frames with errors: " + std::to_string(damaged_) : "")
           + (problem_.empty() ? "" : " (" + problem_ + ")");
}

}  // namespace camera
