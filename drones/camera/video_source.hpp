// The sources that are videos: files, V4L2 devices and network cameras.
#pragma once

#include "source.hpp"

#include <login_file.hpp>

namespace camera {

/// 640x480 if nothing is given (0), 4:3 if one side is.
cv::Size size_or_default(cv::Size size);

std::unique_ptr<Source> open_video(const std::string& path, bool loop, cv::MatAllocator* memory);

/// The requested or reported mode of a device. Empty or 0: driver default, or unknown.
struct DeviceForm {
    std::string format;  ///< four letters: "MJPG"
    cv::Size size;
    double fps = 0;
};
/// "MJPG 1280x720 at 30 fps"
std::string to_text(const DeviceForm& form);
/// Does the reported mode match the requested one?
bool fits(const DeviceForm& asked, const DeviceForm& got);
/// Each frame has the reported mode; one message reports a difference to the requested one.
/// @throws std::runtime_error  saying what is missing
std::unique_ptr<Source> open_device(const std::string& path, const DeviceForm& asked, cv::MatAllocator* memory);

/// Limits of a network camera.
struct UrlLimits {
    std::int64_t pixels = 40'000'000;         ///< of an image
    std::int64_t bytes = 16 << 20;            ///< of a packet; over HTTP also from one packet of video to the next
    std::int64_t allocation = 160 << 20;      ///< bytes in one piece: an image of that size has 4 for each pixel
    std::int64_t rtsp_allocation = 80 << 20;  ///< the same where bytes over UDP are not counted; 2 for each pixel
    long reply = 64 * 1024;                   ///< bytes of the body of an RTSP reply
    int streams = 16;
    int scans = 100;  ///< of a JPEG: each costs the time of the whole image
    bool redirects = false;
    /// For tests, which show that the limits are needed.
    static UrlLimits none();
};

struct UrlSettings {
    std::string url;  ///< without login
    std::optional<capture::Credentials> login;
    std::string transport = "tcp";  ///< of RTSP: tcp or udp
    bool basic_over_http = false;   ///< may the password be sent unencrypted over http:// and rtsp://?
    std::string certificate = {};   ///< file of the certificate to trust for https; empty: those of the system
    UrlLimits limits = {};
};
/// A login whose file names a camera is sent to no other.
/// @throws std::runtime_error  when the login is for another camera, or cannot be read
UrlSettings url_settings(const SourceSettings& settings);
/// Opening takes at most 20 s, an image 10 s. The end of the stream is the end of the source.
std::unique_ptr<Source> open_url(const UrlSettings& settings, cv::MatAllocator* memory);

}  // namespace camera
