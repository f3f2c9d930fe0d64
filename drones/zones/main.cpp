// The zones drone receives tracks, and publishes counts and events per zone and line.
#include "report.hpp"

#include <frame_order.hpp>
#include <hive/drone.hpp>
#include <media_fields.hpp>

#include <stdexcept>

namespace {

class ZonesDrone {
public:
    explicit ZonesDrone(hive::Drone& drone) : counts_(declare(drone)), events_(declare_events(drone))
    {
        drone.on_change([this] { apply(); });
        drone.on_event(
            "tracks", "application/json", [this](const hive::Event& event) { take(event); },
            "tracks of one frame after the other, or boxes without numbers");
    }

private:
    hive::Output declare(hive::Drone& drone)
    {
        drone.parameter("zones", zones_, hive::anything(),
                        "polygons, as NAME: X,Y X,Y X,Y; NAME: ...; shares of the image, 0 to 1");
        drone.parameter("lines", lines_, hive::anything(),
                        "lines of two points, as NAME: X,Y X,Y; ...; a track from left to right of it counts as in");
        drone.parameter("anchor", anchor_, hive::one_of({"foot", "centre"}),
                        "point of a box that counts: middle of its lower side, or its centre");
        drone.parameter(
            "margin", counter_.margin, hive::between(0, 0.5),
            "distance beyond an outline or line from which a change counts, as a share of the image height");
        drone.parameter("hold", counter_.hold, hive::between(0, 3600).in("s"),
                        "time without a track until it has ended");
        drone.parameter("boxes", boxes_, hive::anything(),
                        "name of the array of boxes in the header; empty: tracks, or the only array");
        drone.parameter("fps", fps_, hive::between(0, 1000).in("fps"),
                        "frame rate for measuring dwell time; 0: use the file or capture time");
        return drone.output("counts", "application/json", "zones, lines and tracks of each frame, in the header");
    }

    static hive::Output declare_events(hive::Drone& drone)
    {
        return drone.output("events", "application/json", "one event for each enter, leave and cross, in the header");
    }

    /// Reads both before it changes anything: an error keeps the old shapes.
    void apply()
    {
        const auto zones = read("zones", zones_, zones::read_zones), lines = read("lines", lines_, zones::read_lines);
        counter_.arrange(zones, lines);
        const Times used{anchor_, fps_};
        restart_ = restart_ || used != used_;  // earlier places and times are not comparable with later ones
        used_ = used;
    }

    static std::vector<zones::Shape> read(const std::string& parameter, const std::string& text,
                                          std::vector<zones::Shape> (*reader)(const std::string&))
    {
        try {
            return reader(text);
        } catch (const std::invalid_argument& error) {
            throw hive::Error(hive::Errc::refused, parameter + ": " + error.what());
        }
    }

    void take(const hive::Event& event)
    {
        const auto anchor = anchor_ == "foot" ? zones::Anchor::foot : zones::Anchor::centre;
        const auto frame = zones::read_frame(event.header, boxes_, anchor);
        const bool continues = order_.continues(event);
        const bool of_file = event.header.contains("media_time_us");
        if (!continues || std::exchange(restart_, false))
            emit(counter_.restart(), of_file);
        const zones::Moment now{frame_order::time_of(event, fps_), event.identity.captured_us};
        emit(counter_.next(now, frame.width / frame.height, frame.observations), of_file && fps_ == 0);
        auto header = zones::counts_header(counter_, frame, now);
        media_fields::pass_on(event.header, header);
        counts_.emit(std::move(header));
    }

    void emit(const std::vector<zones::Occurrence>& occurrences, bool of_file) const
    {
        for (const auto& one : occurrences)
            events_.emit(zones::event_header(one, of_file));
    }

    struct Times {
        std::string anchor = "foot";
        double fps = 0;
        bool operator==(const Times&) const = default;
    };
    std::string zones_, lines_, anchor_ = "foot", boxes_;
    double fps_ = 0;
    bool restart_ = false;
    Times used_;
    zones::Counter counter_;
    frame_order::Order order_;
    hive::Output counts_, events_;
};

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"zones", "Counts tracks in zones and across lines.", true},
                           [](hive::Drone& drone) {
                               ZonesDrone zones(drone);
                               drone.run();
                           });
}
