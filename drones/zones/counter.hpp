// Counts tracks that enter and leave zones and cross lines; the algorithm of the zones drone, without Hive.
#pragma once

#include "shapes.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace zones {

/// When a frame was captured.
struct Moment {
    double seconds = 0;            ///< on the clock by which dwell time is measured
    std::int64_t captured_us = 0;  ///< since 1970
};

/// A track in one frame.
struct Observation {
    std::optional<std::int64_t> id = {};  ///< none: only counted where it is now
    Point anchor = {};                    ///< relative
    bool seen = true;                     ///< false: predicted, so its place does not count
};

struct Occurrence {
    enum class Kind { enter, leave, cross };
    Kind kind = Kind::enter;
    std::string shape = {};  ///< name of the zone or line
    std::int64_t id = 0;
    Moment at = {};
    double dwell = 0;    ///< leave: seconds since it entered
    bool lost = false;   ///< leave: the track ended inside; `at` is when it was seen last
    bool right = false;  ///< cross: from left to right
};

struct Zone {
    Shape shape = {};
    std::int64_t entered = 0, left = 0;
    double dwell = 0;                             ///< of all that left, seconds
    int unnumbered = 0;                           ///< boxes without id that are inside now
    std::map<std::int64_t, Moment> present = {};  ///< tracks inside, and when they entered
};

struct Line {
    Shape shape = {};
    std::int64_t in = 0, out = 0;
};

/// The same observations at the same times give the same counts.
class Counter {
public:
    double margin = 0.01;  ///< of the image height: how far beyond an outline or a line a change counts
    double hold = 1;       ///< seconds without an observation after which a track has ended

    /// A shape that keeps its name and its points keeps its counts and its tracks.
    void arrange(const std::vector<Shape>& zones, const std::vector<Shape>& lines);
    /// The next frame. A time before the last one restarts. @param aspect  width of the image divided by its height
    std::vector<Occurrence> next(Moment now, double aspect, const std::vector<Observation>& observations);
    /// All tracks end, as when the source changes; counts stay.
    std::vector<Occurrence> restart();

    [[nodiscard]] const std::vector<Zone>& zones() const { return zones_; }
    [[nodiscard]] const std::vector<Line>& lines() const { return lines_; }

private:
    struct Side {
        int side = 0;          ///< -1 left, 1 right of the line by at least the margin; 0: neither yet
        bool through = false;  ///< its last pass was between the two points of the line, not outside
    };
    struct Path {
        std::optional<Point> last = {};
        Moment seen = {};
        double listed = 0;
        std::map<std::string, Side> sides = {};  ///< by line
    };
    void observe(const Observation& one, Moment now, double aspect, std::vector<Occurrence>& found);
    void observe_zone(Zone& zone, std::int64_t id, Point place, double aspect, Moment now,
                      std::vector<Occurrence>& found) const;
    void observe_line(Line& line, std::int64_t id, Path& path, Point place, double aspect, Moment now,
                      std::vector<Occurrence>& found) const;
    void end(std::int64_t id, Moment seen, std::vector<Occurrence>& found);

    std::vector<Zone> zones_;
    std::vector<Line> lines_;
    std::map<std::int64_t, Path> paths_;
    double last_seconds_ = 0;
};

}  // namespace zones
