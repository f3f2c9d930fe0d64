// The sources that are videos: files and V4L2 devices, which OpenCV's VideoCapture reads, and network cameras.
#pragma once

#include "source.hpp"

#include <login_file.hpp>

namespace camera {

/// 640x480 if nothing is given (0), 4:3 if one side is.
cv::Size size_or_default(cv::Size size);

std::unique_ptr<Source> open_video(const std::string& path, bool loop, cv::MatAllocator* memory);
std::unique_ptr<Source> open_device(const std::string& path, cv::Size size, double fps, cv::MatAllocator* memory);

struct UrlSettings {
    std::string url;  ///< without login
    std::optional<capture::Credentials> login;
    std::string transport = "tcp";  ///< of RTSP: tcp or udp
};
/// Opening takes at most 20 s, a picture 10 s. The end of the stream is the end of the source.
std::unique_ptr<Source> open_url(const UrlSettings& settings, cv::MatAllocator* memory);

}  // namespace camera
