// What FFmpeg logs while it reads: the only way to see a camera's reply before FFmpeg acts on it, and to learn which of
// its limits was reached, or that a file ends too early. The texts are those of libavformat 59 and libavutil 57; tests
// hold each of them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace camera {

/// Called on the thread that called FFmpeg. Must not throw.
class FfmpegLog {
public:
    /// A line of the head of a reply (HTTP, RTSP), before it is parsed.
    virtual void reply_line(std::string_view /*line*/) {}
    /// Bytes of one packet of RTP that comes over TCP, before they are read.
    virtual void rtp_packet(int /*bytes*/) {}
    /// The description of an RTSP stream (SDP, RFC 8866).
    virtual void description(std::string_view /*text*/) {}
    /// Pixels of a picture that is refused because of its size.
    virtual void refused_pixels(std::int64_t /*width*/, std::int64_t /*height*/) {}
    virtual void refused_streams() {}
    virtual void refused_format() {}
    /// The decoder of JPEG has invented a part of a picture.
    virtual void damaged_scan() {}
    /// An error in what is read, which FFmpeg may pass over: it tells some of them in no other way.
    virtual void demuxer_error(const std::string& /*text*/) {}

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
