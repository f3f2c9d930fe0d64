// Reads tracks and boxes from the header of an event.
#pragma once

#include "counter.hpp"

#include <hive/json.hpp>

namespace zones {

enum class Anchor { foot, centre };

struct Frame {
    double width = 0, height = 0;  ///< px
    std::vector<Observation> observations = {};
    hive::Json boxes = hive::Json::array();  ///< id, x, y, w, h, confirmed and missing of each, in the same order
};

/// The boxes in the array `name`; without a name `tracks`, or else the only array of objects with x, y, w and h. Omits
/// tracks that are not confirmed; one with `missing` above 0 is not seen.
/// @throws hive::Error  malformed: no width and height, no such array, several, or a box far outside; too_large: more
/// than 256 boxes
Frame read_frame(const hive::Json& header, const std::string& name, Anchor anchor);

}  // namespace zones
