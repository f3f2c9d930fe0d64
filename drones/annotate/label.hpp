// Writes a label beside a box.
#pragma once

#include <opencv2/core/mat.hpp>

#include <string>

namespace annotate {

/// @param text  printable ASCII
/// @param box   px; the label stands above it, or inside where there is no room above
void write_label(cv::Mat& picture, const std::string& text, const cv::Rect& box, const cv::Scalar& colour);

}  // namespace annotate
