// Samples pixels of the box, and adds each to the two nearest greys and the two nearest hues.
#include "colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace colours {
namespace {

constexpr int greys = 4, hues = 6, half = greys + hues;
static_assert(numbers == 2 * half);
constexpr double max_pixels = 4000;

using Histogram = std::array<double, half>;

/// Hue, in sixths of the circle from red, and saturation, 0 to 1.
struct Hue {
    double place, strength;
};

Hue hue_of(const cv::Vec3b& bgr)
{
    const double b = bgr[0], g = bgr[1], r = bgr[2], most = std::max({b, g, r}), range = most - std::min({b, g, r});
    if (range <= 0)
        return {0, 0};
    const double place = most == r ? (g - b) / range : most == g ? 2 + (b - r) / range : 4 + (r - g) / range;
    // Below a tenth of saturation, or in the dark, a hue is noise.
    const double saturation = range / most, bright = std::clamp((most - 30) / 50, 0.0, 1.0);
    return {place < 0 ? place + 6 : place, bright * std::clamp((saturation - 0.1) / 0.3, 0.0, 1.0)};
}

void count(Histogram& histogram, const cv::Vec3b& bgr)
{
    const Hue hue = hue_of(bgr);
    const double level = (0.114 * bgr[0] + 0.587 * bgr[1] + 0.299 * bgr[2]) / 255 * (greys - 1);
    const int darker = std::min(static_cast<int>(level), greys - 2), before = static_cast<int>(hue.place) % hues;
    const double lighter_share = level - darker, after_share = hue.place - static_cast<int>(hue.place);
    const auto at = [&](int place) -> double& { return histogram[static_cast<std::size_t>(place)]; };
    at(darker) += (1 - hue.strength) * (1 - lighter_share);
    at(darker + 1) += (1 - hue.strength) * lighter_share;
    at(greys + before) += hue.strength * (1 - after_share);
    at(greys + (before + 1) % hues) += hue.strength * after_share;
}

/// Is the pixel within the ellipse that fills the box?
bool inside(const cv::Rect& box, int x, int y)
{
    const double across = (x - box.x + 0.5) / box.width * 2 - 1, down = (y - box.y + 0.5) / box.height * 2 - 1;
    return across * across + down * down <= 1;
}

cv::Vec3b colour_at(const cv::Mat& image, int x, int y)
{
    return image.channels() == 3 ? image.at<cv::Vec3b>(y, x) : cv::Vec3b::all(image.at<unsigned char>(y, x));
}

}  // namespace

std::vector<int> of(const cv::Mat& image, const cv::Rect& box, const cv::Mat& mask)
{
    const cv::Rect seen = box & cv::Rect({}, image.size());
    const int step = std::max(1, static_cast<int>(std::sqrt(seen.area() / max_pixels)));
    std::array<Histogram, 2> halves{};
    double pixels = 0;
    for (int y = seen.y; y < seen.br().y; y += step)
        for (int x = seen.x; x < seen.br().x; x += step)
            if (mask.empty() ? inside(box, x, y) : mask.at<unsigned char>(y, x) == 255) {
                count(halves[y < box.y + box.height / 2 ? 0 : 1], colour_at(image, x, y));
                ++pixels;
            }
    if (pixels == 0)
        return {};
    std::vector<int> result;
    for (const Histogram& histogram : halves)
        for (const double part : histogram)
            result.push_back(static_cast<int>(std::lround(200 * part / pixels)));
    return result;
}

}  // namespace colours
