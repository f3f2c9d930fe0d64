// Reads zones and lines as a user writes them: `door: 0.1,0.2 0.4,0.2 0.4,0.9; shop: ...`.
#pragma once

#include "geometry.hpp"

#include <string>
#include <vector>

namespace zones {

/// A polygon or a line with its name.
struct Shape {
    std::string name;
    std::vector<Point> points;  ///< relative
    bool operator==(const Shape&) const = default;
};

inline constexpr std::size_t max_shapes = 16, max_points = 32, max_name = 32;

/// Polygons of 3 to max_points corners; empty text: none.
/// @throws std::invalid_argument  names the zone and what is wrong with it
std::vector<Shape> read_zones(const std::string& text);
/// Lines of 2 points each; empty text: none.
/// @throws std::invalid_argument  names the line and what is wrong with it
std::vector<Shape> read_lines(const std::string& text);

}  // namespace zones
