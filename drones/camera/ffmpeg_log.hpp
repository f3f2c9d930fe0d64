// What FFmpeg logs while it reads from a camera: the only way to see a reply before FFmpeg acts on it, and to learn
// which of its limits was reached. The texts are those of libavformat 59 and libavutil 57; tests hold each of them.
#pragma once

#include <cstdint>
#include <string_view>

namespace camera {

/// Called on the thread that called FFmpeg. Must not throw.
class FfmpegLog {
public:
    /// A line of the head of a reply (HTTP, RTSP), before it is parsed.
    virtual void reply_line(std::string_view line) = 0;
    /// Bytes of one packet of RTP that comes over TCP, before they are read.
    virtual void rtp_packet(int bytes) = 0;
    /// Pixels of a picture that is refused because of its size.
    virtual void refused_pixels(std::int64_t width, std::int64_t height) = 0;
    virtual void refused_streams() = 0;
    virtual void refused_format() = 0;

protected:
    ~FfmpegLog() = default;
};

/// While it lives, what FFmpeg logs on this thread goes to `log`. Nothing is printed, then or later.
class FfmpegLogWatch {
public:
    explicit FfmpegLogWatch(FfmpegLog& log);
    ~FfmpegLogWatch();
    FfmpegLogWatch(const FfmpegLogWatch&) = delete;
    FfmpegLogWatch& operator=(const FfmpegLogWatch&) = delete;
};

}  // namespace camera
