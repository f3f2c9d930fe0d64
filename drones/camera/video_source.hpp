// The sources that are videos: files and V4L2 devices, which OpenCV's VideoCapture reads, and network cameras.
#pragma once

#include "source.hpp"

#include <login_file.hpp>

namespace camera {

/// 640x480 if nothing is given (0), 4:3 if one side is.
cv::Size size_or_default(cv::Size size);

std::unique_ptr<Source> open_video(const std::string& path, bool loop, cv::MatAllocator* memory);

/// What is asked of a device, and what it says that it gives. Empty or 0: as it likes, or unknown.
struct DeviceForm {
    std::string format;  ///< four letters: "MJPG"
    cv::Size size;
    double fps = 0;
};
/// "MJPG 1280x720 at 30 fps"
std::string to_text(const DeviceForm& form);
/// Does a device that was asked for the one give the other?
bool fits(const DeviceForm& asked, const DeviceForm& got);
/// What the device gives is told with each picture, and once in a sentence where it is not what was asked for.
/// @throws std::runtime_error  saying what is missing
std::unique_ptr<Source> open_device(const std::string& path, const DeviceForm& asked, cv::MatAllocator* memory);

struct UrlSettings {
    std::string url;  ///< without login
    std::optional<capture::Credentials> login;
    std::string transport = "tcp";  ///< of RTSP: tcp or udp
};
/// Opening takes at most 20 s, a picture 10 s. The end of the stream is the end of the source.
std::unique_ptr<Source> open_url(const UrlSettings& settings, cv::MatAllocator* memory);

}  // namespace camera
