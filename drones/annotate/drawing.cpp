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

std::vector<cv::Point> pixels(const Region& region, cv::Size image)
{
    std::vector<cv::Point> points;
    for (const auto& point : region.points)
        points.push_back(pixel({point.x * (image.width - 1), point.y * (image.height - 1)}));
    return points;
}

const cv::Scalar& region_colour(const Region& region) { return region.closed ? white : yellow; }

/// After all lines, which would cross them.
void write_labels(cv::Mat& image, const std::vector<Region>& regions, const std::vector<Mark>& marks)
{
    std::vector<cv::Rect> taken;
    for (const Region& region : regions)
        write_label(image, region.label, cv::boundingRect(pixels(region, image.size())), region_colour(region), taken);
    for (const Mark& mark : marks)
        write_label(image, mark.label, pixels(mark.box), Drawing::colour_of(mark.coloured_by), taken);
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

void Drawing::draw(const cv::Mat& image, const Marks& marks, cv::Mat& result) const
{
    if (image.channels() == 1)
        cv::cvtColor(image, result, cv::COLOR_GRAY2BGR);
    else
        image.copyTo(result);
    const bool other_size = !marks.seen.empty() && marks.seen != cv::Size2d(image.size());
    for (const Region& region : marks.regions)
        draw(result, region);
    std::vector<Mark> shown;
    for (const Mark& mark : marks.all)
        if (!mark.uncertain || uncertain != Uncertain::hidden)
            shown.push_back(other_size ? scaled(mark, image.cols / marks.seen.width, image.rows / marks.seen.height)
                                       : mark);
    for (const Mark& mark : shown)
        draw(result, mark);
    if (labels)
        write_labels(result, marks.regions, shown);
}

/// 2 px up to 480 px of the shorter side: a thinner line is hard to see, and in an image of 2160 px 9 px.
int Drawing::width_for(const cv::Mat& image) const
{
    const int side = std::min(image.rows, image.cols);
    return thickness > 0 ? thickness : std::clamp(static_cast<int>(std::lround(side / 240.0)), 2, 20);
}

void Drawing::draw(cv::Mat& image, const Mark& mark) const
{
    const auto colour = colour_of(mark.coloured_by);
    for (const Shape& shape : mark.shapes)
        draw(image, shape, mark);
    if (mark.framed && mark.uncertain && uncertain == Uncertain::dashed)
        dashed_box(image, pixels(mark.box), colour, width_for(image));
    else if (mark.framed)
        cv::rectangle(image, pixels(mark.box), colour, width_for(image), cv::LINE_AA);
}

/// Dots are small in a small box, where they would hide what they mark.
void Drawing::draw(cv::Mat& image, const Shape& shape, const Mark& mark) const
{
    const auto colour = colour_of(mark.coloured_by);
    const int width = width_for(image), dot = std::clamp(pixel(mark.box.height / 30), (width + 1) / 2, 2 * width);
    std::vector<cv::Point> points;
    for (const auto& point : shape.points)
        points.push_back(pixel(point));
    if (shape.form == Shape::Form::area)
        fill(image, points, colour);
    if (shape.form != Shape::Form::dots)
        return cv::polylines(image, points, shape.form != Shape::Form::line, colour, width, cv::LINE_AA);
    for (const auto& point : points)
        cv::circle(image, point, dot, colour, cv::FILLED, cv::LINE_AA);
}

void Drawing::draw(cv::Mat& image, const Region& region) const
{
    const auto points = pixels(region, image.size());
    const int width = width_for(image);
    for (const auto& [colour, wide] : {std::pair(black, width + 2), {region_colour(region), width}}) {
        cv::polylines(image, points, region.closed, colour, wide, cv::LINE_AA);
        if (!region.closed)
            arrow_to_the_right(image, points[0], points[1], colour, 12 * width, wide);
    }
}

}  // namespace annotate
