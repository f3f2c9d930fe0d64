// With libswscale, as OpenCV's VideoCapture does it, so that the pixels are the same.
#include "frame_converter.hpp"

namespace camera {
namespace {

/// libswscale works on blocks of pixels: in narrower rows it omits the last columns, or writes past the end.
constexpr int block = 16;

cv::Mat padded(cv::Size size)
{
    const int width = (size.width / block + 1) * block;
    return cv::Mat(size.height, width, CV_8UC3)(cv::Rect({}, size));
}

}  // namespace

cv::Mat FrameConverter::image(const AVFrame& frame, int quarter_turns)
{
    const cv::Size size(frame.width, frame.height);
    cv::Mat result;
    result.allocator = memory_;
    const bool direct = size.width % block == 0 && quarter_turns == 0;
    if (direct)
        result.create(size, CV_8UC3);
    const cv::Mat target = direct ? result : padded(size);
    scaler_.reset(sws_getCachedContext(scaler_.release(), size.width, size.height,
                                       static_cast<AVPixelFormat>(frame.format), size.width, size.height,
                                       AV_PIX_FMT_BGR24, SWS_BICUBIC, nullptr, nullptr, nullptr));
    if (!scaler_)
        throw std::runtime_error("its images cannot be converted");
    std::uint8_t* const rows[] = {target.data};
    const int strides[] = {static_cast<int>(target.step)};
    sws_scale(scaler_.get(), frame.data, frame.linesize, 0, size.height, rows, strides);
    if (quarter_turns != 0)
        cv::rotate(target, result, quarter_turns - 1);  // cv::ROTATE_90_CLOCKWISE is 0
    else if (!direct)
        target.copyTo(result);
    return result;
}

}  // namespace camera
