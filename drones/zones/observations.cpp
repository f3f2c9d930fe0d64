#include "observations.hpp"

#include <hive/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace zones {
namespace {

constexpr std::size_t max_boxes = 256;
constexpr double max_px = 1e6;

[[noreturn]] void malformed(const std::string& text) { throw hive::Error(hive::Errc::malformed, text); }

bool is_number(const hive::Json& object, const char* key)
{
    const auto field = object.find(key);
    return field != object.end() && field->is_number() && std::abs(field->get<double>()) <= max_px;
}

bool is_box(const hive::Json& value)
{
    return value.is_object()
           && std::ranges::all_of(std::array{"x", "y", "w", "h"}, [&](auto key) { return is_number(value, key); });
}

bool are_boxes(const hive::Json& value) { return value.is_array() && std::ranges::all_of(value, is_box); }

const hive::Json& named(const hive::Json& header, const std::string& name)
{
    const auto field = header.find(name);
    if (field == header.end() || !are_boxes(*field))
        malformed("the header has no array of boxes named " + hive::in_quotes(name));
    return *field;
}

const hive::Json& array_of_boxes(const hive::Json& header, const std::string& name)
{
    if (!name.empty() || header.contains("tracks"))
        return named(header, name.empty() ? "tracks" : name);
    const hive::Json* found = nullptr;
    for (const auto& [key, value] : header.items())
        if (are_boxes(value)) {
            if (found)
                malformed("the header has several arrays of boxes; name one with the parameter `boxes`");
            found = &value;
        }
    if (!found)
        malformed("the header has no array of boxes: objects with the numbers x, y, w and h");
    return *found;
}

double side(const hive::Json& header, const char* key)
{
    if (!is_number(header, key) || !(header[key].get<double>() > 0))
        malformed("the header has no width and height of the image, so relative zones cannot be placed");
    return header[key];
}

bool is_confirmed(const hive::Json& box)
{
    const auto field = box.find("confirmed");
    return field == box.end() || !field->is_boolean() || field->get<bool>();
}

Observation observation_of(const hive::Json& box, const Frame& frame, Anchor anchor)
{
    Observation one;
    if (const auto id = box.find("id"); id != box.end() && id->is_number_integer())
        one.id = id->get<std::int64_t>();
    const double down = anchor == Anchor::foot ? 1 : 0.5;
    one.anchor = {(box["x"].get<double>() + box["w"].get<double>() / 2) / frame.width,
                  (box["y"].get<double>() + down * box["h"].get<double>()) / frame.height};
    one.seen = !is_number(box, "missing") || box["missing"].get<double>() <= 0;
    return one;
}

/// Of a track only what others need to draw it.
hive::Json short_form(const hive::Json& box)
{
    hive::Json result;
    for (const char* key : {"id", "x", "y", "w", "h", "confirmed", "missing"})
        if (const auto field = box.find(key); field != box.end() && (field->is_number() || field->is_boolean()))
            result[key] = *field;
    return result;
}

}  // namespace

Frame read_frame(const hive::Json& header, const std::string& name, Anchor anchor)
{
    Frame frame{side(header, "width"), side(header, "height")};
    const hive::Json& array = array_of_boxes(header, name);
    if (array.size() > max_boxes)
        throw hive::Error(hive::Errc::too_large, "more than " + std::to_string(max_boxes) + " boxes in one frame");
    for (const hive::Json& box : array)
        if (is_confirmed(box)) {
            frame.observations.push_back(observation_of(box, frame, anchor));
            frame.boxes.push_back(short_form(box));
        }
    return frame;
}

}  // namespace zones
