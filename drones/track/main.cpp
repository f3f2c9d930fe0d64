// The track drone receives boxes, and publishes tracks with lasting numbers.
#include "boxes.hpp"

#include <hive/drone.hpp>
#include <frame_order.hpp>
#include <media_fields.hpp>

namespace {

void track_drone(hive::Drone& drone)
{
    track::Tracker tracker;
    frame_order::Order order;
    std::string boxes;
    double fps = 0, used_fps = 0;
    drone.parameter("boxes", boxes, hive::anything(),
                    "name of the array of boxes in the header; empty: the only array");
    drone.parameter("confirm", tracker.confirm, hive::between(1, 1000), "boxes in a row until a track is confirmed");
    drone.parameter("forget", tracker.forget, hive::between(1, 10000),
                    "pictures in a row without a box until a confirmed track ends");
    drone.parameter("gate", tracker.gate, hive::between(0.01, 10),
                    "how far a box may be from where it is expected, in diagonals of the box");
    drone.parameter("agility", tracker.agility, hive::between(0.01, 100),
                    "how much the speed may change, in sides of the box per s^2");
    drone.parameter("strong", tracker.strong, hive::between(-100, 100),
                    "a box with a lower score begins no track, and goes only to one that no other box wants");
    drone.parameter("appearance", tracker.appearance, hive::between(0, 1),
                    "how much the colours of boxes count beside their motion; 0: motion alone");
    drone.parameter("max_gap", tracker.max_gap, hive::between(0.01, 3600).in("s"),
                    "all tracks end when pictures are further apart");
    drone.parameter("fps", fps, hive::between(0, 1000).in("fps"),
                    "frame rate to count time in pictures; 0: the time in the file, or that of the capture");
    const hive::Output tracks = drone.output("tracks", "application/json", "the tracks, in the header; no body");
    drone.on_change([&] {
        if (fps != used_fps)
            tracker.restart();  // times before and after do not compare
        used_fps = fps;
    });
    drone.on_event(
        "boxes", "application/json",
        [&](const hive::Event& event) {
            const auto found = track::boxes_in(event.header, boxes);
            if (!order.goes_on(event))
                tracker.restart();
            tracker.width = track::number_in(event.header, "width");
            tracker.height = track::number_in(event.header, "height");
            hive::Json header{{"tracks", track::to_json(tracker.next(frame_order::time_of(event, fps), found))}};
            for (const char* size : {"width", "height"})
                if (event.header.contains(size))
                    header[size] = event.header[size];
            media_fields::pass_on(event.header, header);
            tracks.emit(std::move(header));
        },
        "boxes of one picture after the other");
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"track", "Follows things through boxes.", true}, track_drone);
}
