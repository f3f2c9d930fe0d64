// Draws boxes, lines, dots and labels, in pixels of the picture that is drawn on.
#include "drawing.hpp"

#include "label.hpp"
#include "strokes.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

namespace annotate {
namespace {

const cv::Scalar green(60, 220, 60), white(235, 235, 235), yellow(0, 220, 255);

/// A coordinate that OpenCV's own arithmetic takes: it is far outside of every picture anyway.
int pixel(double value) { return static_cast<int>(std::lround(std::clamp(value, -32000.0, 32000.0))); }

cv::Point pixel(const cv::Point2d& point) { return {pixel(point.x), pixel(point.y)}; }

cv::Rect pixels(const cv::Rect2d& box) { return {pixel(box.tl()), pixel(box.br())}; }

/// The mark in a picture of another size.
Mark scaled(Mark mark, double across, double down)
{
    const auto place = [&](const cv::Point2d& point) { return cv::Point2d(point.x * across, point.y * down); };
    mark.box = {place(mark.box.tl()), place(mark.box.br())};
    for (auto& shape : mark.shapes)
        std::ranges::transform(shape.points, shape.points.begin(), place);
    return mark;
}

/// Spreads similar texts over all numbers (FNV-1a), the same in each run.
std::uint32_t spread(const std::string& text)
{
    std::uint32_t hash = 2166136261u;
    for (const char letter : text)
        hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619u;
    return hash ^ hash >> 15;
}

/// 0 to 179. Numbers advance by the golden angle, so that tracks that began together have hues far apart.
double hue_of(const std::string& id)
{
    constexpr double golden_angle = 180 * 0.381966;
    int number = 0;
    const auto [end, error] = std::from_chars(id.data(), id.data() + id.size(), number);
    const bool is_number = error == std::errc() && end == id.data() + id.size() && number >= 0;
    return is_number ? std::floor(std::fmod(number * golden_angle, 180)) : spread(id) % 180;
}

}  // namespace

cv::Scalar Drawing::colour_of(const std::string& id)
{
    if (id.empty())
        return green;
    const auto number = spread(id);
    const cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar(hue_of(id), 150 + number / 180 % 100, 255));
    cv::Mat bgr;
    cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
    return bgr.at<cv::Vec3b>(0, 0);
}

void Drawing::draw(const cv::Mat& picture, const Marks& marks, cv::Mat& result) const
{
    if (picture.channels() == 1)
        cv::cvtColor(picture, result, cv::COLOR_GRAY2BGR);
    else
        picture.copyTo(result);
    const bool other_size = !marks.seen.empty() && marks.seen != cv::Size2d(picture.size());
    for (const Region& region : marks.regions)
        draw(result, region);
    for (const Mark& mark : marks.all)
        draw(result,
             other_size ? scaled(mark, picture.cols / marks.seen.width, picture.rows / marks.seen.height) : mark);
}

/// 2 px up to 480 rows: a thinner line is hard to see, and in an image of 2160 rows 9 px.
int Drawing::width_for(const cv::Mat& picture) const
{
    return thickness > 0 ? thickness : std::clamp(static_cast<int>(std::lround(picture.rows / 240.0)), 2, 20);
}

void Drawing::draw(cv::Mat& picture, const Mark& mark) const
{
    if (mark.uncertain && uncertain == Uncertain::hidden)
        return;
    const auto colour = colour_of(mark.id);
    for (const Shape& shape : mark.shapes)
        draw(picture, shape, colour);
    if (mark.framed && mark.uncertain && uncertain == Uncertain::dashed)
        dashed_box(picture, pixels(mark.box), colour, width_for(picture));
    else if (mark.framed)
        cv::rectangle(picture, pixels(mark.box), colour, width_for(picture), cv::LINE_AA);
    if (labels && !mark.label.empty())
        write_label(picture, mark.label, pixels(mark.box), colour);
}

void Drawing::draw(cv::Mat& picture, const Shape& shape, const cv::Scalar& colour) const
{
    const int width = width_for(picture);
    std::vector<cv::Point> points;
    for (const auto& point : shape.points)
        points.push_back(pixel(point));
    if (shape.form == Shape::Form::area)
        fill(picture, points, colour);
    if (shape.form != Shape::Form::dots)
        return cv::polylines(picture, points, shape.form != Shape::Form::line, colour, width, cv::LINE_AA);
    for (const auto& point : points)
        cv::circle(picture, point, 2 * width, colour, cv::FILLED, cv::LINE_AA);
}

void Drawing::draw(cv::Mat& picture, const Region& region) const
{
    std::vector<cv::Point> points;
    for (const auto& point : region.points)
        points.push_back(pixel({point.x * (picture.cols - 1), point.y * (picture.rows - 1)}));
    const int width = width_for(picture);
    const auto colour = region.closed ? white : yellow;
    cv::polylines(picture, points, region.closed, colour, width, cv::LINE_AA);
    if (!region.closed)
        arrow_to_the_right(picture, points[0], points[1], colour, width);
    if (labels && !region.label.empty())
        write_label(picture, region.label,
                    region.closed ? cv::boundingRect(points) : cv::Rect(points[0], picture.size()), colour);
}

}  // namespace annotate
