// The face drone receives pictures, and publishes boxes of frontal faces and annotated pictures.
#include "face_finder.hpp"

#include <hive/drone.hpp>
#include <hive/vision/annotated.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>

#include <opencv2/core/utility.hpp>

#include <stdexcept>

namespace {

using face::FaceFinder;

hive::Json to_header(const std::vector<cv::Rect>& faces, const cv::Mat& picture)
{
    hive::Json boxes = hive::Json::array();
    for (const cv::Rect& box : faces)
        boxes.push_back({{"x", box.x}, {"y", box.y}, {"w", box.width}, {"h", box.height}});
    return {{"faces", std::move(boxes)}, {"width", picture.cols}, {"height", picture.rows}};
}

void face_drone(hive::Drone& drone)
{
    FaceFinder finder;
    std::string cascade = face::default_cascade, loaded;
    drone.parameter("scale", finder.scale, hive::between(1.01, 2),
                    "step between image scales; smaller finds more and takes longer");
    drone.parameter("min_neighbors", finder.min_neighbors, hive::between(0, 100),
                    "detections that must agree on a face");
    drone.parameter("min_size", finder.min_size, hive::between(1, 16384).in("px"), "side of the smallest face");
    drone.parameter("max_size", finder.max_size, hive::between(0, 16384).in("px"),
                    "side of the largest face; 0: no limit");
    drone.parameter("equalise", finder.equalise, hive::anything(), "equalise the grey levels first");
    drone.parameter("cascade", cascade, hive::anything().by_operator(), "file of the Haar or LBP cascade");
    const hive::Output faces = drone.output("faces", "application/json", "the boxes, in the header; no body");
    const hive::Output annotated = drone.output("annotated", hive::vision::image_types,
                                                "the picture with the faces framed", hive::vision::encoder());
    hive::vision::LoanAllocator loans([&](std::size_t bytes) { return annotated.loan(bytes); });

    const auto load = [&] {
        if (cascade == loaded)
            return;
        finder.load(cascade);
        loaded = cascade;
    };
    drone.on_start([&] {
        cv::setNumThreads(1);  // one drone, one core: to use more, start more drones
        load();
    });
    drone.on_change([&] {
        if (finder.max_size != 0 && finder.max_size < finder.min_size)
            throw hive::Error(hive::Errc::refused, "max_size is smaller than min_size");
        load();
    });
    drone.on_event(
        "image", hive::vision::image_types,
        [&](const hive::Event& event) {
            const cv::Mat picture = hive::vision::view(event);
            const auto found = finder.find(picture);
            hive::Json header = to_header(found, picture);
            faces.emit(header);
            hive::vision::emit_annotated(annotated, loans, std::move(header), picture,
                                         [&](cv::Mat& canvas) { FaceFinder::draw(canvas, found); });
        },
        "pictures to look for faces in");
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"face", "Finds frontal faces in pictures."}, face_drone);
}
