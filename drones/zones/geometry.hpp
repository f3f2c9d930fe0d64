// Points, polygons and directed lines in an image: which side, how far, inside or outside.
#pragma once

#include <span>

namespace zones {

/// x to the right, y down. Relative: 0 to 1 of width and height of the image.
struct Point {
    double x = 0, y = 0;
    bool operator==(const Point&) const = default;
};

/// @param polygon  at least 3 corners, not repeated at the end
bool contains(std::span<const Point> polygon, Point point);
double distance_to_segment(Point a, Point b, Point point);
/// Above 0: `point` lies to the right of an observer who stands at `a` and looks to `b`.
double signed_distance(Point a, Point b, Point point);
/// Where the path between two points on different sides of the line meets it: 0 at `a`, 1 at `b`.
double share_of_line(Point a, Point b, Point from, Point to);
/// Do two of its sides meet, other than neighbours at their corner?
bool crosses_itself(std::span<const Point> polygon);
/// Above or equal to 0.
double area(std::span<const Point> polygon);

}  // namespace zones
