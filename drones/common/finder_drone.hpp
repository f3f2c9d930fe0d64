// The frame of a drone that finds things in images: it publishes the results, and the image with the results drawn in.
#pragma once

#include "media_fields.hpp"

#include <hive/drone.hpp>
#include <hive/vision/annotated.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>

#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

#include <utility>

namespace finder_drone {

/// Names and help of the ports other than the output `annotated`.
struct Ports {
    const char *input, *input_help, *output, *output_help, *annotated_help;
};

/// Runs until the drone stops.
/// @param finder  declare(drone) declares its parameters; apply() loads what they select, and if it throws the old
///                values stay; find(image), header(found, image) and draw(canvas, found) are called for each image
template <class Finder>
void run(hive::Drone& drone, Finder&& finder, const Ports& ports)
{
    finder.declare(drone);
    const hive::Output output = drone.output(ports.output, "application/json", ports.output_help);
    const hive::Output annotated =
        drone.output("annotated", hive::vision::image_types, ports.annotated_help, hive::vision::encoder());
    hive::vision::LoanAllocator loans([&](std::size_t bytes) { return annotated.loan(bytes); });
    drone.on_start([&] {
        cv::setNumThreads(1);  // one drone, one core: to use more, start more drones
        cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // relevant errors are exceptions
        finder.apply();
    });
    drone.on_change([&] { finder.apply(); });
    drone.on_event(
        ports.input, hive::vision::image_types,
        [&](const hive::Event& event) {
            const cv::Mat image = hive::vision::view(event);
            const auto found = finder.find(image);
            hive::Json header = finder.header(found, image);
            media_fields::pass_on(event.header, header);
            output.emit(header);
            hive::vision::emit_annotated(annotated, loans, std::move(header), image,
                                         [&](cv::Mat& canvas) { finder.draw(canvas, found); });
        },
        ports.input_help);
    drone.run();
}

}  // namespace finder_drone
