#include "counter.hpp"

#include <algorithm>
#include <limits>

namespace zones {
namespace {

/// Distances are measured in image heights, so that they are the same in all directions.
Point in_heights(Point relative, double aspect) { return {relative.x * aspect, relative.y}; }

std::vector<Point> in_heights(const std::vector<Point>& relative, double aspect)
{
    std::vector<Point> points;
    for (const Point point : relative)
        points.push_back(in_heights(point, aspect));
    return points;
}

/// A box that is cut at the border of the image has its anchor on the border, which must not be outside of a zone that
/// reaches the border.
Point inside_image(Point relative)
{
    constexpr double least = 1e-6;
    return {std::clamp(relative.x, least, 1 - least), std::clamp(relative.y, least, 1 - least)};
}

/// No track passes the border of the image, so a side there needs no margin.
bool on_border(Point a, Point b)
{
    return (a.x == b.x && (a.x == 0 || a.x == 1)) || (a.y == b.y && (a.y == 0 || a.y == 1));
}

double distance_to_outline(const std::vector<Point>& relative, Point place, double aspect)
{
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < relative.size(); ++i) {
        const Point a = relative[i], b = relative[(i + 1) % relative.size()];
        if (!on_border(a, b))
            nearest = std::min(nearest, distance_to_segment(in_heights(a, aspect), in_heights(b, aspect), place));
    }
    return nearest;
}

template <class Counted>
std::vector<Counted> arranged(const std::vector<Counted>& before, const std::vector<Shape>& shapes)
{
    std::vector<Counted> result;
    for (const Shape& shape : shapes) {
        const auto same = std::ranges::find(before, shape, &Counted::shape);
        result.push_back(same != before.end() ? *same : Counted{.shape = shape});
    }
    return result;
}

}  // namespace

void Counter::arrange(const std::vector<Shape>& zones, const std::vector<Shape>& lines)
{
    for (const Line& line : lines_)
        if (std::ranges::count(lines, line.shape) == 0)
            for (auto& [id, path] : paths_)
                path.sides.erase(line.shape.name);
    zones_ = arranged(zones_, zones);
    lines_ = arranged(lines_, lines);
}

std::vector<Occurrence> Counter::next(Moment now, double aspect, const std::vector<Observation>& observations)
{
    std::vector<Occurrence> found;
    if (now.seconds < last_seconds_)
        found = restart();
    last_seconds_ = now.seconds;
    for (Zone& zone : zones_)
        zone.unnumbered = 0;
    for (const Observation& one : observations)
        observe(one, now, aspect, found);
    for (auto path = paths_.begin(); path != paths_.end();)
        if (now.seconds - path->second.listed > hold) {
            end(path->first, path->second.seen, found);
            path = paths_.erase(path);
        } else {
            ++path;
        }
    return found;
}

std::vector<Occurrence> Counter::restart()
{
    std::vector<Occurrence> found;
    for (const auto& [id, path] : paths_)
        end(id, path.seen, found);
    paths_.clear();
    last_seconds_ = -std::numeric_limits<double>::infinity();
    return found;
}

void Counter::observe(const Observation& one, Moment now, double aspect, std::vector<Occurrence>& found)
{
    const Point place = in_heights(inside_image(one.anchor), aspect);
    if (!one.id) {
        for (Zone& zone : zones_)
            zone.unnumbered += contains(in_heights(zone.shape.points, aspect), place);
        return;
    }
    Path& path = paths_[*one.id];
    path.listed = now.seconds;
    if (!one.seen)
        return;
    for (Zone& zone : zones_)
        observe_zone(zone, *one.id, place, aspect, now, found);
    for (Line& line : lines_)
        observe_line(line, *one.id, path, place, aspect, now, found);
    path.last = one.anchor;
    path.seen = now;
}

void Counter::observe_zone(Zone& zone, std::int64_t id, Point place, double aspect, Moment now,
                           std::vector<Occurrence>& found) const
{
    const bool was_inside = zone.present.contains(id);
    const bool inside = contains(in_heights(zone.shape.points, aspect), place);
    if (inside == was_inside || distance_to_outline(zone.shape.points, place, aspect) < margin)
        return;
    if (inside) {
        zone.present[id] = now;
        ++zone.entered;
        found.push_back({.kind = Occurrence::Kind::enter, .shape = zone.shape.name, .id = id, .at = now});
        return;
    }
    const double dwell = now.seconds - zone.present[id].seconds;
    zone.present.erase(id);
    ++zone.left;
    zone.dwell += dwell;
    found.push_back({.kind = Occurrence::Kind::leave, .shape = zone.shape.name, .id = id, .at = now, .dwell = dwell});
}

void Counter::observe_line(Line& line, std::int64_t id, Path& path, Point place, double aspect, Moment now,
                           std::vector<Occurrence>& found) const
{
    const Point a = in_heights(line.shape.points[0], aspect), b = in_heights(line.shape.points[1], aspect);
    const double distance = signed_distance(a, b, place);
    Side& known = path.sides[line.shape.name];
    if (path.last) {
        const Point before = in_heights(inside_image(*path.last), aspect);
        if ((signed_distance(a, b, before) < 0) != (distance < 0)) {
            const double share = share_of_line(a, b, before, place);
            known.through = share >= 0 && share <= 1;
        }
    }
    if (std::abs(distance) < margin)
        return;
    const int side = distance < 0 ? -1 : 1;
    const bool crossed = known.side != 0 && side != known.side && known.through;
    known = {.side = side};
    if (!crossed)
        return;
    ++(side > 0 ? line.in : line.out);
    found.push_back(
        {.kind = Occurrence::Kind::cross, .shape = line.shape.name, .id = id, .at = now, .right = side > 0});
}

void Counter::end(std::int64_t id, Moment seen, std::vector<Occurrence>& found)
{
    for (Zone& zone : zones_) {
        const auto visit = zone.present.find(id);
        if (visit == zone.present.end())
            continue;
        const double dwell = seen.seconds - visit->second.seconds;
        zone.present.erase(visit);
        ++zone.left;
        zone.dwell += dwell;
        found.push_back({.kind = Occurrence::Kind::leave,
                         .shape = zone.shape.name,
                         .id = id,
                         .at = seen,
                         .dwell = dwell,
                         .lost = true});
    }
}

}  // namespace zones
