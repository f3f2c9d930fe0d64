// Fits the distribution, and measures the Mahalanobis distance of each pixel.
#include "skin.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace gesture {
namespace {

constexpr std::size_t fewest_pixels = 20;
constexpr double near_median = 16;  ///< levels of colour: further away is something else

std::vector<cv::Vec3b> pixels_at(const cv::Mat& image, const cv::Mat& where)
{
    std::vector<cv::Vec3b> pixels;
    for (int y = 0; y < image.rows; ++y)
        for (int x = 0; x < image.cols; ++x)
            if (where.at<unsigned char>(y, x))
                pixels.push_back(image.at<cv::Vec3b>(y, x));
    return pixels;
}

double median(const std::vector<cv::Vec3b>& pixels, int channel)
{
    std::vector<unsigned char> values;
    for (const cv::Vec3b& pixel : pixels)
        values.push_back(pixel[channel]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Those that have about the colour of most.
void keep_the_alike(std::vector<cv::Vec3b>& pixels)
{
    const double cr = median(pixels, 1), cb = median(pixels, 2);
    std::erase_if(pixels, [&](const cv::Vec3b& pixel) {
        return std::abs(pixel[1] - cr) > near_median || std::abs(pixel[2] - cb) > near_median;
    });
}

}  // namespace

std::optional<SkinColour> SkinColour::learn(const cv::Mat& image, const cv::Mat& where, Spread least)
{
    cv::Mat colours;
    cv::cvtColor(image, colours, cv::COLOR_BGR2YCrCb);
    auto pixels = pixels_at(colours, where);
    if (pixels.size() < fewest_pixels)
        return std::nullopt;
    keep_the_alike(pixels);
    if (pixels.size() < fewest_pixels)
        return std::nullopt;
    SkinColour skin;
    for (const cv::Vec3b& pixel : pixels)
        skin.mean_ += cv::Vec3d(pixel);
    skin.mean_ *= 1.0 / static_cast<double>(pixels.size());
    cv::Matx33d covariance = cv::Matx33d::zeros();
    for (const cv::Vec3b& pixel : pixels) {
        const cv::Vec3d apart = cv::Vec3d(pixel) - skin.mean_;
        covariance += apart * apart.t();
    }
    covariance *= 1.0 / static_cast<double>(pixels.size());
    covariance += cv::Matx33d::diag(
        {least.brightness * least.brightness, least.colour * least.colour, least.colour * least.colour});
    skin.inverse_ = covariance.inv();
    return skin;
}

double SkinColour::distance(const SkinColour& other) const
{
    const cv::Vec3d apart = other.mean_ - mean_;
    return std::sqrt(apart.dot(inverse_ * apart));
}

cv::Mat SkinColour::mask(const cv::Mat& image, double deviations) const
{
    cv::Mat colours, result(image.size(), CV_8UC1);
    cv::cvtColor(image, colours, cv::COLOR_BGR2YCrCb);
    const double most = deviations * deviations;
    for (int y = 0; y < colours.rows; ++y) {
        const auto* from = colours.ptr<cv::Vec3b>(y);
        auto* to = result.ptr<unsigned char>(y);
        for (int x = 0; x < colours.cols; ++x) {
            const cv::Vec3d apart = cv::Vec3d(from[x]) - mean_;
            to[x] = apart.dot(inverse_ * apart) <= most ? 255 : 0;
        }
    }
    return result;
}

}  // namespace gesture
