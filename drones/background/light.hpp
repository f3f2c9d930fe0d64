// Distinguishes a change of the light from things in front of the camera. Plain OpenCV.
#pragma once

#include <opencv2/core/mat.hpp>

#include <optional>
#include <vector>

namespace background {

/// A small copy, each pixel the mean of a part, so that noise and small movements hardly count.
cv::Mat reduced(const cv::Mat& image);

/// How many times as bright each channel of the image is, if the image is mostly the known background in another
/// light (exposure, daylight, lamps): at least half of the places agree, and all channels change by about the same
/// number, so that a large object of another colour does not match.
/// @param image, known  reduced; of one size and number of channels
std::optional<std::vector<double>> change_of_light(const cv::Mat& image, const cv::Mat& known);

/// The image with each channel multiplied by its factor.
cv::Mat in_the_light(const cv::Mat& image, const std::vector<double>& gains);

}  // namespace background
