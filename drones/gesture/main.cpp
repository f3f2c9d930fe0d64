// The gesture drone receives silhouettes or pictures, and publishes hands and their fingers.
#include "gesture_finder.hpp"
#include "silhouette.hpp"

#include <hive/drone.hpp>
#include <hive/vision/annotated.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>

namespace {

using gesture::Hand;

hive::Json to_json(const cv::Point& point) { return {{"x", point.x}, {"y", point.y}}; }

hive::Json to_json(const Hand& hand)
{
    const auto tenths = [](double value) { return std::round(value * 10) / 10; };
    hive::Json tips = hive::Json::array();
    for (const cv::Point& tip : hand.tips)
        tips.push_back(to_json(tip));
    hive::Json json{{"x", hand.box.x},
                    {"y", hand.box.y},
                    {"w", hand.box.width},
                    {"h", hand.box.height},
                    {"palm", {{"x", hand.palm.x}, {"y", hand.palm.y}, {"radius", tenths(hand.radius)}}},
                    {"fingers", tips.size()},
                    {"pose", gesture::pose(hand)}};
    json["tips"] = std::move(tips);
    if (hand.angle)
        json["angle"] = tenths(*hand.angle);
    return json;
}

hive::Json to_header(const std::vector<Hand>& hands, const cv::Mat& picture)
{
    hive::Json list = hive::Json::array();
    for (const Hand& hand : hands)
        list.push_back(to_json(hand));
    return {{"hands", std::move(list)}, {"width", picture.cols}, {"height", picture.rows}};
}

void declare(hive::Drone& drone, gesture::Silhouette& silhouette, gesture::GestureFinder& finder)
{
    const auto byte = hive::between(0, 255);
    drone.parameter("silhouette", silhouette.from, hive::one_of({"mask", "skin"}),
                    "the picture is a mask, or its skin-coloured parts are taken");
    drone.parameter("level", silhouette.level, hive::between(1, 255),
                    "of a mask: the least grey level that belongs to the silhouette");
    drone.parameter("max_hands", finder.max_hands, hive::between(1, 8),
                    "how many silhouettes are read, the largest first");
    drone.parameter("min_area", finder.min_area, hive::between(0, 100).in("%"),
                    "part of the picture: smaller silhouettes are ignored");
    drone.parameter("smooth", finder.smooth, hive::between(0, 31).in("px"),
                    "narrower specks, hairs and gaps are smoothed away");
    drone.parameter("y_min", silhouette.skin.y_min, byte, "skin in YCrCb: least brightness");
    drone.parameter("y_max", silhouette.skin.y_max, byte, "skin: most brightness");
    drone.parameter("cr_min", silhouette.skin.cr_min, byte, "skin: least Cr");
    drone.parameter("cr_max", silhouette.skin.cr_max, byte, "skin: most Cr");
    drone.parameter("cb_min", silhouette.skin.cb_min, byte, "skin: least Cb");
    drone.parameter("cb_max", silhouette.skin.cb_max, byte, "skin: most Cb");
}

void gesture_drone(hive::Drone& drone)
{
    gesture::Silhouette silhouette;
    gesture::GestureFinder finder;
    declare(drone, silhouette, finder);
    const hive::Output gestures = drone.output("gesture", "application/json", "the hands, in the header; no body");
    const hive::Output annotated = drone.output("annotated", hive::vision::image_types,
                                                "the picture with the hands marked", hive::vision::encoder());
    hive::vision::LoanAllocator loans([&](std::size_t bytes) { return annotated.loan(bytes); });
    drone.on_start([] { cv::setNumThreads(1); });  // one drone, one core: to use more, start more drones
    drone.on_event(
        "mask", hive::vision::image_types,
        [&](const hive::Event& event) {
            const cv::Mat picture = hive::vision::view(event);
            const auto hands = finder.find(silhouette.of(picture));
            hive::Json header = to_header(hands, picture);
            gestures.emit(header);
            hive::vision::emit_annotated(annotated, loans, std::move(header), picture,
                                         [&](cv::Mat& canvas) { gesture::draw(canvas, hands); });
        },
        "masks, or pictures with silhouette=skin");
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"gesture", "Counts the fingers of hands in silhouettes."}, gesture_drone);
}
