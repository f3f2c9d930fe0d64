#include "fit.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace detect {
namespace {

const cv::Scalar margin_grey(114, 114, 114);  // what YOLO models were trained with

}  // namespace

Fit::Fit(cv::Size image, cv::Size input, Kind kind) : image_(image), input_(input)
{
    scale_ = {static_cast<double>(input.width) / image.width, static_cast<double>(input.height) / image.height};
    if (kind != Kind::stretch) {
        const auto [least, most] = std::minmax(scale_.x, scale_.y);
        const double scale = kind == Kind::crop ? most : least;
        scale_ = {scale, scale};
    }
    offset_ = {(input.width - scale_.x * image.width) / 2, (input.height - scale_.y * image.height) / 2};
}

cv::Mat Fit::input_from(const cv::Mat& image) const
{
    cv::Mat colour = image, input(input_, CV_8UC3, margin_grey);
    if (image.channels() == 1)
        cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
    const auto part = cv::Rect(in_image(cv::Rect2d({}, cv::Size2d(input_)))) & cv::Rect({}, image_);
    cv::Rect place(cvRound(std::max(offset_.x, 0.0)), cvRound(std::max(offset_.y, 0.0)),
                   cvRound(std::min(scale_.x * image_.width, 1.0 * input_.width)),
                   cvRound(std::min(scale_.y * image_.height, 1.0 * input_.height)));
    place = (place + cv::Size(place.width == 0, place.height == 0)) & cv::Rect({}, input_);
    cv::resize(colour(part), input(place), place.size());
    return input;
}

cv::Point2d Fit::in_image(const cv::Point2d& in_input) const
{
    return {(in_input.x - offset_.x) / scale_.x, (in_input.y - offset_.y) / scale_.y};
}

cv::Rect2d Fit::in_image(const cv::Rect2d& in_input) const
{
    return {in_image(in_input.tl()), cv::Size2d(in_input.width / scale_.x, in_input.height / scale_.y)};
}

}  // namespace detect
