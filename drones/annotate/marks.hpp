// Reads marks (boxes, points, lines) from the headers of other drones' events. Knows nothing of Hive.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/types.hpp>

#include <string>
#include <vector>

namespace annotate {

/// Points that belong to a mark, px.
struct Shape {
    enum class Form { dots, line, outline };
    Form form = Form::dots;
    std::vector<cv::Point2d> points;
};

/// Something that was found.
struct Mark {
    cv::Rect2d box = {};     ///< px
    std::string id = {};     ///< of a track, the same from picture to picture; empty: none
    std::string label = {};  ///< what to write beside it: "person #3 87 %"; printable ASCII, 48 characters at most
    std::vector<Shape> shapes = {};
};

struct Marks {
    std::vector<Mark> all = {};
    cv::Size2d seen = {};  ///< of the picture they were found in, px; empty: not told
};

/// The marks in a header: every object with numbers x, y, w and h that stands in one of its fields, alone or in an
/// array. Beside these a mark may have
/// - class, kind, gesture, pose, label (texts or whole numbers), id, score (0 to 1), speed (px/s): they make the label;
/// - any array of points, each [x, y] or {"x", "y"}: trail is drawn as a line, hull and contour as an outline, others
/// as dots. What is anything else, or over a million, is left out.
Marks marks_in(const nlohmann::json& header);

}  // namespace annotate
