// Writes a label next to a box.
#pragma once

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace annotate {

/// @param text   printable ASCII
/// @param box    px; without a label if it is outside of the image. The label is above it, or else inside or below,
///               where the image has room and there is no other label
/// @param taken  areas of existing labels; the new one is added
void write_label(cv::Mat& image, const std::string& text, const cv::Rect& box, const cv::Scalar& colour,
                 std::vector<cv::Rect>& taken);

}  // namespace annotate
