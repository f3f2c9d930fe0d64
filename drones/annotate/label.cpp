// Fits a label into an image: its size, its words and its place.
#include "label.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace annotate {
namespace {

constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
/// Size of letters: 1 in images of 960 rows; smaller ones than the minimum cannot be read.
constexpr double smallest_letters = 0.35, usual_letters = 0.4, largest_letters = 4;
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
    const int weight = std::max(1, static_cast<int>(std::lround(1.5 * size))), margin = size < usual_letters ? 1 : 3;
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

}  // namespace

/// Dark on a plate of the mark's colour, above the box, or inside it where there is no room above. In a small picture
/// a label gives way: it takes smaller letters, then loses its last words, and where not even the first one fits, or
/// the plate would hide more than half of its own box from inside, there is none.
void write_label(cv::Mat& picture, const std::string& text, const cv::Rect& box, const cv::Scalar& colour)
{
    const auto lettering = lettering_for(text, picture.size());
    if (!lettering)
        return;
    cv::Point corner = box.tl();
    const bool above = corner.y >= lettering->plate.height;
    if (!above && box.height < 2 * lettering->plate.height)
        return;
    corner.y = above ? corner.y - lettering->plate.height : std::max(corner.y, 0);
    corner.x = std::clamp(corner.x, 0, std::max(0, picture.cols - lettering->plate.width));
    cv::rectangle(picture, {corner, lettering->plate}, colour, cv::FILLED);
    cv::putText(picture, lettering->text, corner + lettering->start, font, lettering->size, cv::Scalar::all(0),
                lettering->weight, cv::LINE_AA);
}

}  // namespace annotate
