// Converts frames decoded by FFmpeg into images.
#pragma once

#include <ffmpeg.hpp>

#include <opencv2/core.hpp>

namespace camera {

/// For one thread.
class FramePictures {
public:
    /// @param memory  where the pixels shall lie; null: OpenCV's own
    explicit FramePictures(cv::MatAllocator* memory) : memory_(memory) {}

    /// BGR. @param quarter_turns  clockwise, as it is to be shown
    /// @throws std::runtime_error  FFmpeg cannot convert it
    cv::Mat picture(const AVFrame& frame, int quarter_turns = 0);

private:
    cv::MatAllocator* memory_;
    ffmpeg::Scaler scaler_;
};

}  // namespace camera
