#include "geometry.hpp"

#include <algorithm>
#include <cmath>

namespace zones {
namespace {

double cross(Point a, Point b, Point point) { return (b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x); }

/// 0 at `a`, 1 at `b`: the foot of the perpendicular from `point`.
double share(Point a, Point b, Point point)
{
    const double x = b.x - a.x, y = b.y - a.y;
    return ((point.x - a.x) * x + (point.y - a.y) * y) / (x * x + y * y);
}

Point between(Point a, Point b, double share) { return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)}; }

bool touches(Point a, Point b, Point point)
{
    return cross(a, b, point) == 0 && share(a, b, point) >= 0 && share(a, b, point) <= 1;
}

bool segments_meet(Point a, Point b, Point c, Point d)
{
    if (touches(a, b, c) || touches(a, b, d) || touches(c, d, a) || touches(c, d, b))
        return true;
    return (cross(a, b, c) < 0) != (cross(a, b, d) < 0) && (cross(c, d, a) < 0) != (cross(c, d, b) < 0);
}

}  // namespace

bool contains(std::span<const Point> polygon, Point point)
{
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        if ((a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x))
            inside = !inside;
    }
    return inside;
}

double distance_to_segment(Point a, Point b, Point point)
{
    const Point nearest = between(a, b, std::clamp(share(a, b, point), 0.0, 1.0));
    return std::hypot(point.x - nearest.x, point.y - nearest.y);
}

double signed_distance(Point a, Point b, Point point) { return cross(a, b, point) / std::hypot(b.x - a.x, b.y - a.y); }

double share_of_line(Point a, Point b, Point from, Point to)
{
    const double before = signed_distance(a, b, from), after = signed_distance(a, b, to);
    return share(a, b, between(from, to, before / (before - after)));
}

bool crosses_itself(std::span<const Point> polygon)
{
    const std::size_t count = polygon.size();
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 2; j < count; ++j)
            if (!(i == 0 && j == count - 1)
                && segments_meet(polygon[i], polygon[i + 1], polygon[j], polygon[(j + 1) % count]))
                return true;
    return false;
}

double area(std::span<const Point> polygon)
{
    double twice = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        twice += a.x * b.y - b.x * a.y;
    }
    return std::abs(twice) / 2;
}

}  // namespace zones
