// Reads marks (boxes, points, lines) from the headers of other drones' events. Independent of Hive.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/types.hpp>

#include <string>
#include <vector>

namespace annotate {

/// Points that belong to a mark, px.
struct Shape {
    enum class Form { dots, line, outline, area };
    Form form = Form::dots;
    std::vector<cv::Point2d> points;
};

/// One detected object.
struct Mark {
    cv::Rect2d box = {};  ///< px
    /// Marks with the same text have the same colour: the id of a track, else its class; empty: green.
    std::string coloured_by = {};
    std::string label = {};  ///< the label: "person #3 87 %"; printable ASCII, 48 characters at most
    std::vector<Shape> shapes = {};
    bool framed = true;      ///< the box is drawn
    bool uncertain = false;  ///< a track that is not confirmed, or whose box is predicted
};

/// A zone or a line of the zones drone.
struct Region {
    std::vector<cv::Point2d> points;  ///< 0 to 1 of width and height of the image
    std::string label = {};           ///< "door 2", "till in 3 out 1"
    bool closed = true;               ///< a polygon; else a line, with an arrow to its right
};

struct Marks {
    std::vector<Mark> all = {};
    std::vector<Region> regions = {};
    cv::Size2d seen = {};  ///< of the image in which they were found, px; empty: unknown
};

/// The marks in a header: every object with numbers x, y, w and h that stands in one of its fields, alone or in an
/// array. A mark may also have
/// - class, kind, gesture, pose, label (texts or whole numbers), id, score (0 to 1), speed (px/s): they make the label;
/// - any array of points, each [x, y], [x, y, score] or {"x", "y"}: trail is drawn as a line, hull, contour and corners
/// as an outline (corners instead of the box), mask as an area, others as dots. Other values, and values over
/// a million, are ignored; so are points with a score below 0.5.
/// - missing (above 0) or confirmed (false): then it is uncertain.
/// Regions are the objects in `zones` and `lines` with an array `points` of at least 3 or 2 points from 0 to 1.
Marks marks_in(const nlohmann::json& header);

}  // namespace annotate
