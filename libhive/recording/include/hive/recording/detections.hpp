// Detections and tracks of one image, as values for the formats of other tools.
#pragma once

#include <hive/event.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hive::recording {

struct Detection {
    double x = 0, y = 0, w = 0, h = 0;    ///< px; x and y are the left upper corner
    std::string category = {};            ///< the box's `class`, or else the kind of the drone
    std::optional<std::int64_t> id = {};  ///< of the track
    std::optional<double> score = {};
    std::optional<bool> confirmed = {};        ///< of a track
    std::optional<std::int64_t> missing = {};  ///< frames since the track was seen
    /// False for a track that is not confirmed or whose box is predicted: no detector found such a box in the image.
    [[nodiscard]] bool certain() const { return confirmed.value_or(true) && missing.value_or(0) <= 0; }
};

struct DetectedImage {
    std::string name = {};  ///< as a file: a safe name without folders, "street_00000012.jpg"
    std::string source = {}, sender = {}, output = {};
    std::int64_t epoch = 0, sequence = 0, captured_us = 0;
    std::optional<std::int64_t> media_time_us = {};  ///< of an image from a video
    std::int64_t width = 0, height = 0;              ///< px; 0: not in the header
    std::vector<Detection> detections = {};
};

/// All boxes in arrays of the header: objects with the numbers x, y, w and h, w and h above 0.
/// The name is that of the image file that `file` in the header names; for a video its name and the number of the
/// capture; without `file` the name of the source and the number of the capture.
/// @throws Error  refused: no field of the header is an array of boxes
DetectedImage detections_in(const Event& event);

}  // namespace hive::recording
