// Finds the boxes in the header of any event, and writes tracks into a header.
#pragma once

#include "tracker.hpp"

#include <hive/json.hpp>

#include <string>
#include <vector>

namespace track {

/// The boxes in the array `name`, or, without a name, in the only field that is an array of boxes (objects with numbers
/// "x", "y", "w", "h" in px; an empty array counts). Also reads "score" (a number) and "colours" (at most 64
/// non-negative numbers), and ignores the rest.
/// @throws hive::Error  malformed: no such array, or several, or a box without area; too_large: more than max_boxes
std::vector<Box> boxes_in(const hive::Json& header, const std::string& name);

/// The number in a field; 0 if missing.
double number_in(const hive::Json& header, const char* key);

/// The `tracks` of the drone's output; px to tenths, seconds to thousandths.
hive::Json to_json(const std::vector<Track>& tracks);

}  // namespace track
