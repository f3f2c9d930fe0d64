#include "report.hpp"

#include <cmath>

namespace zones {
namespace {

double thousandths(double value) { return std::round(value * 1000) / 1000; }

hive::Json points_json(const std::vector<Point>& points)
{
    hive::Json array = hive::Json::array();
    for (const Point point : points)
        array.push_back({point.x, point.y});
    return array;
}

hive::Json zone_json(const Zone& zone, Moment now)
{
    hive::Json present = hive::Json::array();
    for (const auto& [id, since] : zone.present)
        present.push_back({{"id", id}, {"seconds", thousandths(now.seconds - since.seconds)}});
    return {{"name", zone.shape.name},
            {"points", points_json(zone.shape.points)},
            {"occupancy", zone.present.size() + static_cast<std::size_t>(zone.unnumbered)},
            {"entered", zone.entered},
            {"left", zone.left},
            {"mean_dwell", zone.left > 0 ? thousandths(zone.dwell / static_cast<double>(zone.left)) : 0.0},
            {"present", present}};
}

hive::Json line_json(const Line& line)
{
    return {{"name", line.shape.name}, {"points", points_json(line.shape.points)}, {"in", line.in}, {"out", line.out}};
}

}  // namespace

hive::Json counts_header(const Counter& counter, const Frame& frame, Moment now)
{
    hive::Json header{{"zones", hive::Json::array()},
                      {"lines", hive::Json::array()},
                      {"tracks", frame.boxes},
                      {"width", std::llround(frame.width)},
                      {"height", std::llround(frame.height)}};
    for (const Zone& zone : counter.zones())
        header["zones"].push_back(zone_json(zone, now));
    for (const Line& line : counter.lines())
        header["lines"].push_back(line_json(line));
    return header;
}

hive::Json event_header(const Occurrence& one, bool of_file)
{
    constexpr const char* words[] = {"enter", "leave", "cross"};
    const bool cross = one.kind == Occurrence::Kind::cross;
    hive::Json header{{"event", words[static_cast<int>(one.kind)]},
                      {cross ? "line" : "zone", one.shape},
                      {"id", one.id},
                      {"time_us", one.at.captured_us}};
    if (cross)
        header["direction"] = one.right ? "in" : "out";
    if (one.kind == Occurrence::Kind::leave) {
        header["seconds"] = thousandths(one.dwell);
        header["lost"] = one.lost;
    }
    if (of_file)
        header["media_time_us"] = std::llround(one.at.seconds * 1e6);
    return header;
}

}  // namespace zones
