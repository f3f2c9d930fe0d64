// Tells a change of the light from things that come before the camera. Plain OpenCV.
#pragma once

#include <opencv2/core/mat.hpp>

#include <optional>

namespace background {

/// The known background in the light of the picture, if the picture is mostly that: each channel a certain number of
/// times as bright (exposure, daylight, lamps) in at least half of the places, and all channels by about the same
/// number, so that it is no large thing of another colour.
/// @param picture, known  8 bit, of one size and number of channels
std::optional<cv::Mat> in_the_light_of(const cv::Mat& picture, const cv::Mat& known);

}  // namespace background
