// Draws dashed boxes, filled areas and the arrows of lines.
#pragma once

#include <opencv2/core/mat.hpp>

#include <vector>

namespace annotate {

/// @param width  of the line, px; dashes and gaps are four times as long
void dashed_box(cv::Mat& image, const cv::Rect& box, const cv::Scalar& colour, int width);
/// The image shows through the area.
void fill(cv::Mat& image, const std::vector<cv::Point>& outline, const cv::Scalar& colour);
/// `size` px from the middle of the line from `a` to `b`, to the right as seen from `a`: where a crossing counts as in.
void arrow_to_the_right(cv::Mat& image, cv::Point a, cv::Point b, const cv::Scalar& colour, int size, int width);

}  // namespace annotate
