// The boxes that the background drone sends for a foreground, as the track drone takes them.
#pragma once

#include <colours.hpp>
#include <foreground_finder.hpp>
#include <tracker.hpp>

#include <vector>

namespace hive::test {

/// @param scale  of the pixels of the boxes to those of the image
inline std::vector<track::Box> boxes_of(const background::Foreground& found, const cv::Mat& image, double scale = 1)
{
    std::vector<track::Box> boxes;
    for (const auto& [box, area] : found.blobs) {
        const auto seen = colours::of(image, box, found.mask);
        boxes.push_back({.x = box.x * scale,
                         .y = box.y * scale,
                         .w = box.width * scale,
                         .h = box.height * scale,
                         .look = track::look_of({seen.begin(), seen.end()})});
    }
    return boxes;
}

}  // namespace hive::test
