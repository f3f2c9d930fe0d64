// A connection to a network camera with libavformat: every wait has a deadline, and all input has limits.
#pragma once

#include "ffmpeg_log.hpp"
#include "reply_guard.hpp"
#include "video_source.hpp"

#include <ffmpeg.hpp>

#include <chrono>
#include <string>

namespace camera {

/// For one thread.
class UrlInput final : private FfmpegLog {
public:
    using Clock = std::chrono::steady_clock;

    /// Connects, and reads until the format of the stream is known.
    /// @throws std::runtime_error  naming the camera and what is wrong; LoginRefused
    explicit UrlInput(const UrlSettings& settings);
    /// FFmpeg polls this callback until the connection is closed, which is after it has freed the context.
    ~UrlInput() { context_ = nullptr; }
    UrlInput(const UrlInput&) = delete;
    UrlInput& operator=(const UrlInput&) = delete;

    /// The next packet of video that can be decoded; false at the end of the stream.
    bool read(AVPacket& packet);
    /// Passes a packet to a decoder; skips a damaged one, and refuses one whose image is too large.
    void decode(AVCodecContext& decoder, const AVPacket& packet);
    /// Of the packets that read() returns; null before the first.
    [[nodiscard]] const AVStream* video() const;
    /// Frames per second by the description of an RTSP stream; 0: unknown.
    [[nodiscard]] double described_fps() const { return described_fps_; }
    /// The deadline for the next packets, and the error if they miss it.
    void expect_until(Clock::time_point deadline, const char* otherwise);
    /// The URL for display.
    [[nodiscard]] std::string shown() const;

private:
    void reply_line(std::string_view line) override;
    void rtp_packet(int bytes) override;
    void description(std::string_view text) override;
    void refused_pixels(std::int64_t width, std::int64_t height) override;
    void refused_streams() override;
    void refused_format() override;

    void connect();
    static int open_io(AVFormatContext* context, AVIOContext** io, const char* url, int flags, AVDictionary** options);
    [[nodiscard]] bool interrupted();
    [[nodiscard]] std::int64_t bytes_since_packet() const;
    [[nodiscard]] bool choose(const AVPacket& packet);
    void require(int code) const;

    UrlSettings settings_;
    bool rtsp_;
    ReplyGuard guard_;
    Clock::time_point deadline_{};
    const char* otherwise_ = "";
    AVFormatContext* context_ = nullptr;  ///< also while it is being opened
    decltype(AVFormatContext::io_open) default_open_ = nullptr;
    ffmpeg::Input input_;
    std::int64_t http_begin_ = 0;  ///< bytes that had come by HTTP when the last packet was read
    std::int64_t rtp_bytes_ = 0;   ///< that have come by RTP over TCP since the last packet was read
    bool replied_ = false;
    double described_fps_ = 0;
    int stream_ = -1;
};

}  // namespace camera
