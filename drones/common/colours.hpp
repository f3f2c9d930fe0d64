// Describes the colours of an object by a few numbers, so that it can be recognized. Plain OpenCV.
#pragma once

#include <opencv2/core/mat.hpp>

#include <vector>

namespace colours {

/// The length of a description.
inline constexpr int numbers = 20;

/// Two histograms, of the upper and of the lower half, with a sum of about 200 together: four greys from dark to light,
/// and six hues from red on. A value between two of them counts for both in part, so that a small change of light
/// changes little.
/// @param image  8 bit, BGR or grey
/// @param box      px; the part of it that lies in the image is looked at, by at most about 4000 pixels
/// @param mask     8 bit, of the image's size: only where it is 255; empty: an ellipse that fills the box
/// @return         empty without any pixels
std::vector<int> of(const cv::Mat& image, const cv::Rect& box, const cv::Mat& mask = {});

}  // namespace colours
