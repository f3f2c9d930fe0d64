// Interprets the output of a detector network: three layouts, which its shape tells apart.
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace detect {

enum class Layout {
    rows,     ///< 1 x N x (5+C), as YOLOv5 and its kin: centre, size, objectness, a score for each class
    columns,  ///< 1 x (4+C) x N, as YOLOv8 and its kin: centre, size, a score for each class
    corners,  ///< 1 x 1 x N x 7, as SSD: image, class, score, left, top, right, bottom; the corners as shares of the
              ///< input
};

/// The layout of an output of this shape. Without class names (0), the shorter side of a table is taken for one object.
std::optional<Layout> layout_of(const std::vector<int>& shape, std::size_t classes);
/// "1x84x8400"
std::string shape_text(const std::vector<int>& shape);

/// Something that a network claims to see, in px of its input.
struct Candidate {
    cv::Rect2d box;
    int class_index = 0;  ///< from 0; as the model counts, for SSD this is often the background
    double score = 0;     ///< of the best class
};

/// The candidates of an output with the given layout whose score is at least `min_score`.
/// @param input  size of the network's input
std::vector<Candidate> candidates(const cv::Mat& output, Layout layout, cv::Size input, double min_score);

}  // namespace detect
