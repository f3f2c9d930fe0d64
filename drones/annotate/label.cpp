// Fits a label into an image: chooses its size, text and place.
#include "label.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace annotate {
namespace {

constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
/// Size of letters: 1 in images whose shorter side has 960 px; smaller ones than the minimum cannot be read.
constexpr double smallest_letters = 0.35, default_letters = 0.4, largest_letters = 4;
/// A label is at most this share of the image's width, and this one of its height.
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
    const int weight = std::max(1, static_cast<int>(std::lround(1.5 * size))), margin = size < default_letters ? 1 : 3;
    int below = 0;
    const cv::Size letters = cv::getTextSize(text, font, size, weight, &below);
    return {text,
            size,
            weight,
            {letters.width + 2 * margin, letters.height + below + 2 * margin},
            {margin, margin + letters.height}};
}

/// With the letter size for the image; else with smaller letters; else with fewer words; else nothing.
std::optional<Lettering> lettering_for(std::string text, cv::Size image)
{
    const auto fits = [&](const Lettering& one) {
        return one.plate.width <= widest * image.width && one.plate.height <= highest * image.height;
    };
    const double usual = std::clamp(std::min(image.width, image.height) / 960.0, default_letters, largest_letters);
    for (;;) {
        for (const double size : {usual, smallest_letters})
            if (auto found = lettering(text, size); fits(found))
                return found;
        const auto last = text.rfind(' ');
        if (last == std::string::npos)
            return std::nullopt;
        text.resize(last);
    }
}

/// Above the box, inside it unless that hides more than half of it, or below it; if no place is free, the first one.
std::optional<cv::Rect> place_for(cv::Size plate, const cv::Rect& box, cv::Size image,
                                  const std::vector<cv::Rect>& taken)
{
    const int x = std::clamp(box.x, 0, std::max(0, image.width - plate.width));
    std::vector<cv::Rect> places{{{x, box.y - plate.height}, plate}};
    if (box.height >= 2 * plate.height)
        places.push_back({{x, std::max(box.y, 0)}, plate});
    places.push_back({{x, box.br().y}, plate});
    std::erase_if(places, [&](const cv::Rect& place) { return place.y < 0 || place.br().y > image.height; });
    const auto is_free = [&](const cv::Rect& place) {
        return std::ranges::none_of(taken, [&](const cv::Rect& other) { return !(other & place).empty(); });
    };
    const auto found = std::ranges::find_if(places, is_free);
    if (found != places.end())
        return *found;
    return places.empty() ? std::nullopt : std::optional(places[0]);
}

/// Black, or white on a dark plate.
cv::Scalar letters_on(const cv::Scalar& plate)
{
    const double brightness = 0.114 * plate[0] + 0.587 * plate[1] + 0.299 * plate[2];
    return cv::Scalar::all(brightness < 100 ? 255 : 0);
}

}  // namespace

/// In a small image a label has smaller letters, then loses its last words, and is omitted if not even the first one
/// fits.
void write_label(cv::Mat& image, const std::string& text, const cv::Rect& box, const cv::Scalar& colour,
                 std::vector<cv::Rect>& taken)
{
    const cv::Rect seen(box.tl(), cv::Size(std::max(box.width, 1), std::max(box.height, 1)));
    const auto lettering = lettering_for(text, image.size());
    if (text.empty() || !lettering || (seen & cv::Rect({}, image.size())).empty())
        return;
    const auto place = place_for(lettering->plate, box, image.size(), taken);
    if (!place)
        return;
    taken.push_back(*place);
    cv::rectangle(image, *place, colour, cv::FILLED);
    cv::putText(image, lettering->text, place->tl() + lettering->start, font, lettering->size, letters_on(colour),
                lettering->weight, cv::LINE_AA);
}

}  // namespace annotate
