#include "strokes.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace annotate {
namespace {

/// Clips the ends to the image, so that a box far outside costs no more than one inside.
void dashed_line(cv::Mat& image, cv::Point from, cv::Point to, const cv::Scalar& colour, int width)
{
    if (!cv::clipLine(image.size(), from, to))
        return;
    const cv::Point2d path = to - from;
    const double length = std::hypot(path.x, path.y), dash = 4.0 * width;
    for (double at = 0; at <= length; at += 2 * dash) {
        const double end = std::min(at + dash, length), all = std::max(length, 1.0);
        cv::line(image, from + cv::Point(path * (at / all)), from + cv::Point(path * (end / all)), colour, width);
    }
}

}  // namespace

void dashed_box(cv::Mat& image, const cv::Rect& box, const cv::Scalar& colour, int width)
{
    const cv::Point first = box.tl(), last = box.br() - cv::Point(1, 1);
    for (const int y : {first.y, last.y})
        dashed_line(image, {first.x, y}, {last.x, y}, colour, width);
    for (const int x : {first.x, last.x})
        dashed_line(image, {x, first.y}, {x, last.y}, colour, width);
}

void fill(cv::Mat& image, const std::vector<cv::Point>& outline, const cv::Scalar& colour)
{
    constexpr double share = 0.4;  // of the colour
    const cv::Rect part = cv::boundingRect(outline) & cv::Rect({}, image.size());
    if (part.empty())
        return;
    cv::Mat region = image(part), filled = region.clone();
    cv::fillPoly(filled, outline, colour, cv::LINE_8, 0, -part.tl());
    cv::addWeighted(filled, share, region, 1 - share, 0, region);
}

void arrow_to_the_right(cv::Mat& image, cv::Point a, cv::Point b, const cv::Scalar& colour, int size, int width)
{
    const cv::Point2d along = b - a, middle = cv::Point2d(a + b) / 2;
    const double length = std::hypot(along.x, along.y);
    if (length < 1)
        return;
    const cv::Point2d right(-along.y / length * size, along.x / length * size);
    cv::arrowedLine(image, cv::Point(middle), cv::Point(middle + right), colour, width, cv::LINE_AA, 0, 0.4);
}

}  // namespace annotate
