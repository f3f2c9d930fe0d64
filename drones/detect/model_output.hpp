// Interprets the outputs of a detector network: six layouts, which their shapes tell apart.
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace detect {

enum class Layout {
    rows,      ///< 1 x N x (5+C), as YOLOv5 and its kin: centre, size, objectness, a score for each class
    columns,   ///< 1 x (4+C) x N, as YOLOv8, v11 and their kin: centre, size, a score for each class
    corners,   ///< 1 x 1 x N x 7, as SSD: image, class, score, left, top, right, bottom; the corners as shares of the
               ///< input
    finished,  ///< 1 x N x 6, as YOLOv10 and exports with the suppression inside: left, top, right, bottom, score,
               ///< class
    numbered,  ///< N x 7, as YOLOv7's with the suppression inside: image, left, top, right, bottom, class, score
    apart,  ///< two outputs, as SSD's without the suppression: 1 x N x 4 corners as shares of the input, and 1 x N x C
            ///< scores, of which the first is the background's
};

/// Its name, as the parameter `layout` has it: "yolov5", "yolov8", "ssd", "yolov10", "yolov7", "ssd-apart".
std::string_view name_of(Layout layout);

/// A layout, and the outputs in which it is.
struct Place {
    Layout layout;
    std::size_t boxes = 0, scores = 0;  ///< places in the list of outputs; the same one but for `apart`
    bool operator==(const Place&) const = default;
};

/// The layout of a model with outputs of these shapes. Without class names (0), the shorter side of a table is taken
/// for one object. A 1 x N x 6 of at most 1000 rows is `finished`, unless one class is named: no network has so few
/// places to look at, and no suppression leaves more.
/// @param wanted  the name of the only layout to consider; empty: any
std::optional<Place> layout_of(const std::vector<std::vector<int>>& shapes, std::size_t classes,
                               std::string_view wanted = {});
/// "1x84x8400"
std::string shape_text(const std::vector<int>& shape);

/// Something that a network claims to see, in px of its input.
struct Candidate {
    cv::Rect2d box;
    int class_index = 0;  ///< from 0; as the model counts: of SSD 0 is the background
    double score = 0;     ///< of the best class
};

/// The candidates in the outputs whose score is at least `min_score`.
/// @param input  size of the network's input
std::vector<Candidate> candidates(const std::vector<cv::Mat>& outputs, const Place& place, cv::Size input,
                                  double min_score);

}  // namespace detect
