// Compares places on a grid, where both are bright enough and not burnt out: the median ratio of each channel is the
// change of the light.
#include "light.hpp"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace background {
namespace {

constexpr int places = 64;                    ///< along the longer side of the image
constexpr int darkest = 12, brightest = 245;  ///< beyond, a ratio is unreliable
constexpr std::size_t enough_places = 50;
constexpr double noise = 12, share_of_value = 0.12;  ///< a place agrees when it is so near, in grey levels
constexpr double agreeing = 0.5;                     ///< of the places
constexpr double colour_cast = 1.6;                  ///< maximum ratio of the changes of two channels by light

bool tells(int level) { return level >= darkest && level <= brightest; }

double median(std::vector<double>& numbers)
{
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

/// The brightness ratio of a channel of `image`; nothing if too few places are usable.
std::optional<double> gain_of(const cv::Mat& image, const cv::Mat& known)
{
    std::vector<double> ratios;
    for (int y = 0; y < image.rows; ++y)
        for (int x = 0; x < image.cols; ++x)
            if (const int now = *image.ptr(y, x), before = *known.ptr(y, x); tells(now) && tells(before))
                ratios.push_back(static_cast<double>(now) / before);
    return ratios.size() >= enough_places ? std::optional(median(ratios)) : std::nullopt;
}

double agreement(const cv::Mat& image, const cv::Mat& lit)
{
    double agree = 0;
    for (int y = 0; y < image.rows; ++y)
        for (int x = 0; x < image.cols; ++x) {
            const int now = *image.ptr(y, x), expected = *lit.ptr(y, x);
            agree += std::abs(now - expected) <= std::max(noise, share_of_value * expected) ? 1 : 0;
        }
    return agree / static_cast<double>(image.total());
}

}  // namespace

cv::Mat reduced(const cv::Mat& image)
{
    const int step = std::max(1, std::max(image.cols, image.rows) / places);
    cv::Mat small(std::max(1, image.rows / step), std::max(1, image.cols / step), image.type());
    for (int y = 0; y < small.rows; ++y)
        for (int x = 0; x < small.cols; ++x) {
            const cv::Scalar mean =
                cv::mean(image(cv::Rect(x * step, y * step, step, step) & cv::Rect({}, image.size())));
            for (int channel = 0; channel < image.channels(); ++channel)
                small.ptr(y, x)[channel] = cv::saturate_cast<unsigned char>(mean[channel]);
        }
    return small;
}

std::optional<std::vector<double>> change_of_light(const cv::Mat& image, const cv::Mat& known)
{
    if (known.size() != image.size() || known.type() != image.type())
        return std::nullopt;
    std::vector<cv::Mat> seen, remembered;
    cv::split(image, seen);
    cv::split(known, remembered);
    std::vector<double> gains;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const auto gain = gain_of(seen[i], remembered[i]);
        if (!gain)
            return std::nullopt;
        remembered[i].convertTo(remembered[i], -1, *gain);
        if (agreement(seen[i], remembered[i]) < agreeing)
            return std::nullopt;
        gains.push_back(*gain);
    }
    const auto [least, most] = std::ranges::minmax(gains);
    return most <= colour_cast * least ? std::optional(gains) : std::nullopt;
}

cv::Mat in_the_light(const cv::Mat& image, const std::vector<double>& gains)
{
    std::vector<cv::Mat> channels;
    cv::split(image, channels);
    for (std::size_t i = 0; i < channels.size(); ++i)
        channels[i].convertTo(channels[i], -1, gains[i]);
    cv::Mat lit;
    cv::merge(channels, lit);
    return lit;
}

}  // namespace background
