// Converts frames decoded by FFmpeg into images.
#pragma once

#include <ffmpeg.hpp>

#include <opencv2/core.hpp>

namespace camera {

/// For one thread.
class FrameConverter {
public:
    /// @param memory  allocator of the pixels; null: OpenCV's own
    explicit FrameConverter(cv::MatAllocator* memory) : memory_(memory) {}

    /// BGR. @param quarter_turns  clockwise, for display
    /// @throws std::runtime_error  FFmpeg cannot convert it
    cv::Mat image(const AVFrame& frame, int quarter_turns = 0);

private:
    cv::MatAllocator* memory_;
    ffmpeg::Scaler scaler_;
};

}  // namespace camera
