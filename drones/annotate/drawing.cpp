// Draws boxes, lines, dots and labels, in pixels of the picture that is drawn on.
#include "drawing.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

namespace annotate {
namespace {

const cv::Scalar green(60, 220, 60);

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

constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
/// Of letters: below the smallest nobody can read them; in pictures of 960 rows they have size 1.
constexpr double smallest_letters = 0.35, usual_letters = 0.4, largest_letters = 2;
/// A label is at most this share of the picture's width, and this one of its height.
constexpr double widest = 0.5, highest = 0.12;

/// A text, and how it is written.
struct Lettering {
    std::string text;
    double size;
    int weight;
    cv::Size plate;   ///< px, with a margin around the text
    cv::Point start;  ///< of the text, from the left upper corner of the plate
};

Lettering lettering(const std::string& text, double size)
{
    const int weight = size >= 1 ? 2 : 1, margin = size < usual_letters ? 1 : 3;
    int below = 0;
    const cv::Size letters = cv::getTextSize(text, font, size, weight, &below);
    return {text,
            size,
            weight,
            {letters.width + 2 * margin, letters.height + below + 2 * margin},
            {margin, margin + letters.height}};
}

/// As large as the picture demands; else with smaller letters; else with fewer words; else nothing.
std::optional<Lettering> lettering_for(std::string text, cv::Size picture)
{
    const auto fits = [&](const Lettering& one) {
        return one.plate.width <= widest * picture.width && one.plate.height <= highest * picture.height;
    };
    for (;;) {
        for (const double size : {std::clamp(picture.height / 960.0, usual_letters, largest_letters), smallest_letters})
            if (auto found = lettering(text, size); fits(found))
                return found;
        const auto last = text.rfind(' ');
        if (last == std::string::npos)
            return std::nullopt;
        text.resize(last);
    }
}

/// Spreads similar texts over all numbers (FNV-1a), the same in each run.
std::uint32_t spread(const std::string& text)
{
    std::uint32_t hash = 2166136261u;
    for (const char letter : text)
        hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619u;
    return hash ^ hash >> 15;
}

}  // namespace

cv::Scalar Drawing::colour_of(const std::string& id)
{
    if (id.empty())
        return green;
    const auto number = spread(id);
    const cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar(number % 180, 150 + number / 180 % 100, 255));
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
    for (const Mark& mark : marks.all)
        draw(result,
             other_size ? scaled(mark, picture.cols / marks.seen.width, picture.rows / marks.seen.height) : mark);
}

void Drawing::draw(cv::Mat& picture, const Mark& mark) const
{
    const auto colour = colour_of(mark.id);
    for (const Shape& shape : mark.shapes)
        draw(picture, shape, colour);
    cv::rectangle(picture, pixels(mark.box), colour, thickness, cv::LINE_AA);
    if (labels && !mark.label.empty())
        write(picture, mark, colour);
}

void Drawing::draw(cv::Mat& picture, const Shape& shape, const cv::Scalar& colour) const
{
    std::vector<cv::Point> points;
    for (const auto& point : shape.points)
        points.push_back(pixel(point));
    if (shape.form != Shape::Form::dots)
        return cv::polylines(picture, points, shape.form == Shape::Form::outline, colour, thickness, cv::LINE_AA);
    for (const auto& point : points)
        cv::circle(picture, point, 2 * thickness, colour, cv::FILLED, cv::LINE_AA);
}

/// Dark on a plate of the mark's colour, above the box, or inside it where there is no room above. In a small picture
/// a label gives way: it takes smaller letters, then loses its last words, and where not even the first one fits, or
/// the plate would hide more than half of its own box from inside, there is none.
void Drawing::write(cv::Mat& picture, const Mark& mark, const cv::Scalar& colour)
{
    const auto lettering = lettering_for(mark.label, picture.size());
    if (!lettering)
        return;
    cv::Point corner = pixel(mark.box.tl());
    const bool above = corner.y >= lettering->plate.height;
    if (!above && mark.box.height < 2 * lettering->plate.height)
        return;
    corner.y = above ? corner.y - lettering->plate.height : std::max(corner.y, 0);
    corner.x = std::clamp(corner.x, 0, std::max(0, picture.cols - lettering->plate.width));
    cv::rectangle(picture, {corner, lettering->plate}, colour, cv::FILLED);
    cv::putText(picture, lettering->text, corner + lettering->start, font, lettering->size, cv::Scalar::all(0),
                lettering->weight, cv::LINE_AA);
}

}  // namespace annotate
