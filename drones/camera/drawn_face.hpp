// A face drawn from ellipses, which frontal face detectors detect as a real one.
#pragma once

#include <opencv2/core/mat.hpp>

namespace camera {

/// Draws a face into a BGR image. `box` (square) is what a frontal Haar cascade reports for it; hair and chin reach
/// from 0.14 box heights above it to 0.04 below. What lies outside the image is cut off.
void draw_face(cv::Mat& image, const cv::Rect2d& box);

}  // namespace camera
