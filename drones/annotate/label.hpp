// Writes a label next to a box.
#pragma once

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace annotate {

/// @param text   printable ASCII
/// @param box    px; outside of the image it gets no label. The label stands above it, or else inside or below, where
/// the
///               image has room and no other label stands
/// @param taken  areas of existing labels; the new one is added
void write_label(cv::Mat& picture, const std::string& text, const cv::Rect& box, const cv::Scalar& colour,
                 std::vector<cv::Rect>& taken);

}  // namespace annotate
