#include "fit.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace detect {
namespace {

const cv::Scalar margin_grey(114, 114, 114);  // what YOLO models were trained with

}  // namespace

Fit::Fit(cv::Size picture, cv::Size input, Kind kind) : picture_(picture), input_(input)
{
    scale_ = {static_cast<double>(input.width) / picture.width, static_cast<double>(input.height) / picture.height};
    if (kind != Kind::stretch) {
        const auto [least, most] = std::minmax(scale_.x, scale_.y);
        const double scale = kind == Kind::crop ? most : least;
        scale_ = {scale, scale};
    }
    offset_ = {(input.width - scale_.x * picture.width) / 2, (input.height - scale_.y * picture.height) / 2};
}

cv::Mat Fit::input_from(const cv::Mat& picture) const
{
    cv::Mat colour = picture, input(input_, CV_8UC3, margin_grey);
    if (picture.channels() == 1)
        cv::cvtColor(picture, colour, cv::COLOR_GRAY2BGR);
    const auto part = cv::Rect(in_picture(cv::Rect2d({}, cv::Size2d(input_)))) & cv::Rect({}, picture_);
    cv::Rect place(cvRound(std::max(offset_.x, 0.0)), cvRound(std::max(offset_.y, 0.0)),
                   cvRound(std::min(scale_.x * picture_.width, 1.0 * input_.width)),
                   cvRound(std::min(scale_.y * picture_.height, 1.0 * input_.height)));
    place = (place + cv::Size(place.width == 0, place.height == 0)) & cv::Rect({}, input_);
    cv::resize(colour(part), input(place), place.size());
    return input;
}

cv::Point2d Fit::in_picture(const cv::Point2d& in_input) const
{
    return {(in_input.x - offset_.x) / scale_.x, (in_input.y - offset_.y) / scale_.y};
}

cv::Rect2d Fit::in_picture(const cv::Rect2d& in_input) const
{
    return {in_picture(in_input.tl()), cv::Size2d(in_input.width / scale_.x, in_input.height / scale_.y)};
}

}  // namespace detect
