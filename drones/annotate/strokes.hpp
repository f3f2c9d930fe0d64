// Draws dashed boxes and the arrows of lines.
#pragma once

#include <opencv2/core/mat.hpp>

namespace annotate {

/// @param width  of the line, px; dashes and gaps are four times as long
void dashed_box(cv::Mat& picture, const cv::Rect& box, const cv::Scalar& colour, int width);
/// From the middle of the line from `a` to `b`, to the right as seen from `a`: where a crossing counts as in.
void arrow_to_the_right(cv::Mat& picture, cv::Point a, cv::Point b, const cv::Scalar& colour, int width);

}  // namespace annotate
