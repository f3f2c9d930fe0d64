// Draws boxes, lines, dots and labels, in pixels of the image that is drawn on.
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

const cv::Scalar green(60, 220, 60), white(235, 235, 235), yellow(0, 220, 255), black(0, 0, 0);

/// A coordinate that OpenCV's own arithmetic takes: it is far outside of every image anyway.
int pixel(double value) { return static_cast<int>(std::lround(std::clamp(value, -32000.0, 32000.0))); }

cv::Point pixel(const cv::Point2d& point) { return {pixel(point.x), pixel(point.y)}; }

cv::Rect pixels(const cv::Rect2d& box) { return {pixel(box.tl()), pixel(box.br())}; }

std::vector<cv::Point> pixels(const Region& region, cv::Size picture)
{
    std::vector<cv::Point> points;
    for (const auto& point : region.points)
        points.push_back(pixel({point.x * (picture.width - 1), point.y * (picture.height - 1)}));
    return points;
}

const cv::Scalar& region_colour(const Region& region) { return region.closed ? white : yellow; }

/// After all lines, which would cross them.
void write_labels(cv::Mat& picture, const std::vector<Region>& regions, const std::vector<Mark>& marks)
{
    std::vector<cv::Rect> taken;
    for (const Region& region : regions)
        write_label(picture, region.label, cv::boundingRect(pixels(region, picture.size())), region_colour(region),
                    taken);
    for (const Mark& mark : marks)
        write_label(picture, mark.label, pixels(mark.box), Drawing::colour_of(mark.coloured_by), taken);
}

/// The mark in an image of another size.
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
double hue_of(const std::string& text)
{
    constexpr double golden_angle = 180 * 0.381966;
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number = error == std::errc() && end == text.data() + text.size() && number >= 0;
    return is_number ? std::floor(std::fmod(number * golden_angle, 180)) : spread(text) % 180;
}

}  // namespace

cv::Scalar Drawing::colour_of(const std::string& text)
{
    if (text.empty())
        return green;
    const auto number = spread(text);
    const cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar(hue_of(text), 150 + number / 180 % 100, 255));
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
    std::vector<Mark> shown;
    for (const Mark& mark : marks.all)
        if (!mark.uncertain || uncertain != Uncertain::hidden)
            shown.push_back(other_size ? scaled(mark, picture.cols / marks.seen.width, picture.rows / marks.seen.height)
                                       : mark);
    for (const Mark& mark : shown)
        draw(result, mark);
    if (labels)
        write_labels(result, marks.regions, shown);
}

/// 2 px up to 480 px of the shorter side: a thinner line is hard to see, and in an image of 2160 px 9 px.
int Drawing::width_for(const cv::Mat& picture) const
{
    const int side = std::min(picture.rows, picture.cols);
    return thickness > 0 ? thickness : std::clamp(static_cast<int>(std::lround(side / 240.0)), 2, 20);
}

void Drawing::draw(cv::Mat& picture, const Mark& mark) const
{
    const auto colour = colour_of(mark.coloured_by);
    for (const Shape& shape : mark.shapes)
        draw(picture, shape, mark);
    if (mark.framed && mark.uncertain && uncertain == Uncertain::dashed)
        dashed_box(picture, pixels(mark.box), colour, width_for(picture));
    else if (mark.framed)
        cv::rectangle(picture, pixels(mark.box), colour, width_for(picture), cv::LINE_AA);
}

/// Dots are small in a small box, where they would hide what they mark.
void Drawing::draw(cv::Mat& picture, const Shape& shape, const Mark& mark) const
{
    const auto colour = colour_of(mark.coloured_by);
    const int width = width_for(picture), dot = std::clamp(pixel(mark.box.height / 30), (width + 1) / 2, 2 * width);
    std::vector<cv::Point> points;
    for (const auto& point : shape.points)
        points.push_back(pixel(point));
    if (shape.form == Shape::Form::area)
        fill(picture, points, colour);
    if (shape.form != Shape::Form::dots)
        return cv::polylines(picture, points, shape.form != Shape::Form::line, colour, width, cv::LINE_AA);
    for (const auto& point : points)
        cv::circle(picture, point, dot, colour, cv::FILLED, cv::LINE_AA);
}

void Drawing::draw(cv::Mat& picture, const Region& region) const
{
    const auto points = pixels(region, picture.size());
    const int width = width_for(picture);
    for (const auto& [colour, wide] : {std::pair(black, width + 2), {region_colour(region), width}}) {
        cv::polylines(picture, points, region.closed, colour, wide, cv::LINE_AA);
        if (!region.closed)
            arrow_to_the_right(picture, points[0], points[1], colour, 12 * width, wide);
    }
}

}  // namespace annotate
