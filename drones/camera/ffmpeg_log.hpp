// Reads FFmpeg's log: the only way to see a camera's reply before FFmpeg acts on it, and to detect which limit was
// reached, or that a file ends too early. The texts are those of libavformat 59 and libavutil 57; tests check each of
// them.
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
    /// Pixels of an image that is refused because of its size.
    virtual void refused_pixels(std::int64_t /*width*/, std::int64_t /*height*/) {}
    virtual void refused_streams() {}
    virtual void refused_format() {}
    /// The JPEG decoder has invented a part of an image.
    virtual void damaged_scan() {}
    /// An error in the input, which FFmpeg may ignore: some errors are only in the log.
    virtual void demuxer_error(const std::string& /*text*/) {}

protected:
    ~FfmpegLog() = default;
};

/// During its lifetime, FFmpeg's log on this thread goes to `log`. FFmpeg prints nothing, then or later.
class FfmpegLogWatch {
public:
    explicit FfmpegLogWatch(FfmpegLog& log);
    ~FfmpegLogWatch();
    FfmpegLogWatch(const FfmpegLogWatch&) = delete;
    FfmpegLogWatch& operator=(const FfmpegLogWatch&) = delete;
};

}  // namespace camera
