#include "masks.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace detect {
namespace {

constexpr std::size_t max_points = 64;

std::vector<cv::Point> largest_outline(const cv::Mat& mask, const cv::Point& offset)
{
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE, offset);
    const auto area = [](const auto& outline) { return cv::contourArea(outline); };
    const auto largest = std::ranges::max_element(outlines, {}, area);
    return largest == outlines.end() ? std::vector<cv::Point>() : *largest;
}

std::vector<cv::Point> simplified(const std::vector<cv::Point>& outline)
{
    std::vector<cv::Point> result;
    for (double tolerance = 1; result.empty() || result.size() > max_points; tolerance *= 1.5)
        cv::approxPolyDP(outline, result, tolerance, true);
    return result;
}

}  // namespace

std::vector<cv::Point> mask_outline(const cv::Mat& prototypes, const std::vector<float>& coefficients,
                                    const cv::Rect2d& box, cv::Size input)
{
    const cv::Size size(prototypes.size[3], prototypes.size[2]);
    const double across = static_cast<double>(input.width) / size.width,
                 down = static_cast<double>(input.height) / size.height;
    const cv::Point first(static_cast<int>(std::floor(box.x / across)), static_cast<int>(std::floor(box.y / down)));
    const cv::Point last(static_cast<int>(std::ceil(box.br().x / across)),
                         static_cast<int>(std::ceil(box.br().y / down)));
    const cv::Rect part = cv::Rect(first, last) & cv::Rect({}, size);
    if (part.empty())
        return {};
    const cv::Mat rows = prototypes.reshape(1, prototypes.size[1]);
    cv::Mat sum(part.size(), CV_32F, cv::Scalar(0)), whole;
    for (int i = 0; i < rows.rows; ++i)
        cv::scaleAdd(rows.row(i).reshape(1, size.height)(part), coefficients[static_cast<std::size_t>(i)], sum, sum);
    const cv::Rect place(cvRound(part.x * across), cvRound(part.y * down), std::max(1, cvRound(part.width * across)),
                         std::max(1, cvRound(part.height * down)));
    cv::resize(sum, whole, place.size());
    const cv::Rect inside = cv::Rect(box) & place;
    if (inside.empty())
        return {};
    const auto outline = largest_outline(whole(inside - place.tl()) > 0, inside.tl());
    return outline.empty() ? outline : simplified(outline);
}

}  // namespace detect
