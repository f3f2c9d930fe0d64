// The background drone receives images, and publishes the mask of the foreground and its boxes.
#include "foreground_finder.hpp"

#include <colours.hpp>
#include <hive/drone.hpp>
#include <hive/vision/annotated.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>
#include <media_fields.hpp>

#include <opencv2/core/utility.hpp>

#include <string>
#include <utility>

namespace {

using background::Foreground;
using background::ForegroundFinder;

hive::Json boxes_header(const Foreground& found, const cv::Mat& image)
{
    hive::Json boxes = hive::Json::array();
    for (const auto& [box, area] : found.blobs)
        boxes.push_back({{"x", box.x},
                         {"y", box.y},
                         {"w", box.width},
                         {"h", box.height},
                         {"area", area},
                         {"colours", colours::of(image, box, found.mask)}});
    return {{"boxes", std::move(boxes)},
            {"width", found.mask.cols},
            {"height", found.mask.rows},
            {"learned", found.learned}};
}

hive::Json mask_header(const Foreground& found)
{
    hive::Json header = hive::vision::raw_header(found.mask);
    header["learned"] = found.learned;
    return header;
}

hive::Body mask_body(const hive::Output& output, const cv::Mat& mask)
{
    hive::Loan loan = output.loan(mask.total());
    mask.copyTo(cv::Mat(mask.size(), CV_8UC1, loan.data()));
    return loan;
}

void background_drone(hive::Drone& drone)
{
    ForegroundFinder finder;
    std::pair<std::string, std::int64_t> source;  ///< of the last image, and its epoch
    drone.parameter("method", finder.model.method, hive::one_of({"mog2", "knn"}),
                    "mixture of gaussians or nearest neighbours, for each pixel");
    drone.parameter("history", finder.model.history, hive::between(1, 10000),
                    "number of images in the model's history");
    drone.parameter("threshold", finder.model.threshold, hive::between(0, 65025),
                    "squared distance threshold; 0: 16 (mog2), 400 (knn)");
    drone.parameter("shadows", finder.model.shadows, hive::anything(), "mark shadows with 127 in the mask");
    drone.parameter("open", finder.open, hive::between(0, 100).in("px"), "radius: thinner specks are erased; 0: none");
    drone.parameter("close", finder.close, hive::between(0, 100).in("px"), "radius: narrower gaps are filled; 0: none");
    drone.parameter("min_area", finder.min_area, hive::between(1, 65536).in("px"), "minimum foreground area of a box");
    drone.parameter("light", finder.light, hive::between(1, 100).in("%"),
                    "if more than this share of the image is foreground, adapt the model to a possible change of "
                    "light; 100: never");
    const hive::Output boxes =
        drone.output("boxes", "application/json", "the boxes of the foreground, in the header; no body");
    const hive::Output mask =
        drone.output("mask", hive::vision::image_types, "255 in the foreground", hive::vision::encoder());
    const hive::Output foreground = drone.output("foreground", hive::vision::image_types,
                                                 "the image, with a black background", hive::vision::encoder());
    hive::vision::LoanAllocator loans([&](std::size_t bytes) { return foreground.loan(bytes); });
    drone.on_start([] { cv::setNumThreads(1); });  // one drone, one core
    drone.on_event(
        "image", hive::vision::image_types,
        [&](const hive::Event& event) {
            const cv::Mat image = hive::vision::view(event);
            const std::pair seen(event.identity.source, event.identity.epoch);
            if (std::exchange(source, seen) != seen)
                finder.restart();  // another scene, or the same one from its beginning
            const Foreground found = finder.find(image);
            if (found.learned == 1)
                drone.log("learning a background size=" + std::to_string(found.mask.cols) + "x"
                          + std::to_string(found.mask.rows));
            if (found.light_changed)
                drone.log("adapted the known background to new light sequence="
                          + std::to_string(event.identity.sequence));
            hive::Json of_boxes = boxes_header(found, image), of_mask = mask_header(found);
            media_fields::pass_on(event.header, of_boxes);
            media_fields::pass_on(event.header, of_mask);
            boxes.emit(std::move(of_boxes));
            mask.emit(
                std::move(of_mask), [&] { return mask_body(mask, found.mask); }, "image/raw");
            hive::Json of_image{{"width", image.cols}, {"height", image.rows}, {"learned", found.learned}};
            media_fields::pass_on(event.header, of_image);
            hive::vision::emit_annotated(foreground, loans, std::move(of_image), image, [&](cv::Mat& canvas) {
                canvas.setTo(0, found.mask != ForegroundFinder::foreground);
            });
        },
        "images from a fixed camera");
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"background", "Separates moving objects from a learned background.", true},
                           background_drone);
}
