// The sources that OpenCV's VideoCapture reads: video files, V4L2 devices, network cameras.
#pragma once

#include "source.hpp"

namespace camera {

/// 640x480 if nothing is given (0), 4:3 if one side is.
cv::Size size_or_default(cv::Size size);

std::unique_ptr<Source> open_video(const std::string& path, bool loop, cv::MatAllocator* memory);
std::unique_ptr<Source> open_device(const std::string& path, cv::Size size, double fps, cv::MatAllocator* memory);
/// Opening and every picture take at most 2 s.
std::unique_ptr<Source> open_url(const std::string& url, cv::MatAllocator* memory);

}  // namespace camera
