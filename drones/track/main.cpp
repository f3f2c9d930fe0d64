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
    drone.parameter("confirm", tracker.confirm, hive::between(1, 1000), "consecutive boxes to confirm a track");
    drone.parameter("forget", tracker.forget, hive::between(1, 10000), "consecutive misses that end a confirmed track");
    drone.parameter("gate", tracker.gate, hive::between(0.01, 10),
                    "maximum distance from the predicted box, in box diagonals");
    drone.parameter("agility", tracker.agility, hive::between(0.01, 100),
                    "expected acceleration, in box sides per s^2");
    drone.parameter("strong", tracker.strong, hive::between(-100, 100),
                    "a box with a lower score starts no track and only extends unmatched ones");
    drone.parameter("appearance", tracker.appearance, hive::between(0, 1),
                    "weight of box colours against motion; 0: motion only");
    drone.parameter("max_gap", tracker.max_gap, hive::between(0.01, 3600).in("s"),
                    "time between frames that ends all tracks");
    drone.parameter("fps", fps, hive::between(0, 1000).in("fps"),
                    "frame rate for timing by frame count; 0: use the file or capture time");
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
            if (!order.continues(event))
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
        "boxes of consecutive frames");
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"track", "Tracks objects by their boxes.", true}, track_drone);
}
