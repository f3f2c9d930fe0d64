// Finds the array of boxes in the header of an event: objects with the numbers x, y, w and h, px.
#pragma once

#include <hive/error.hpp>
#include <hive/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace box_array {

/// px; no image is that large, and squares are still exact enough.
inline constexpr double max_px = 1e6;

[[noreturn]] inline void malformed(const std::string& text) { throw hive::Error(hive::Errc::malformed, text); }

inline bool is_array_of_boxes(const hive::Json& value)
{
    const auto is_box = [](const hive::Json& box) {
        return box.is_object() && std::ranges::all_of(std::array{"x", "y", "w", "h"}, [&](const char* key) {
                   const auto field = box.find(key);
                   return field != box.end() && field->is_number();
               });
    };
    return value.is_array() && std::ranges::all_of(value, is_box);
}

/// The array of this name; without a name, the only one. An empty array counts.
/// @throws hive::Error  malformed: no such array, several, or a box beyond max_px
inline const hive::Json& array_of_boxes(const hive::Json& header, const std::string& name)
{
    const hive::Json* found = nullptr;
    for (const auto& [key, value] : header.items())
        if ((name.empty() || key == name) && is_array_of_boxes(value)) {
            if (found)
                malformed("the header has several arrays of boxes; name one with the parameter `boxes`");
            found = &value;
        }
    if (!found)
        malformed(name.empty() ? "the header has no array of boxes: objects with the numbers x, y, w and h"
                               : "the header has no array of boxes named " + hive::in_quotes(name));
    for (const hive::Json& box : *found)
        for (const char* key : {"x", "y", "w", "h"})
            if (!(std::abs(box[key].get<double>()) <= max_px))
                malformed("a box is further away than any image reaches");
    return *found;
}

}  // namespace box_array
