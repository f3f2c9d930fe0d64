#include "observations.hpp"

#include <box_array.hpp>

namespace zones {
namespace {

constexpr std::size_t max_boxes = 256;
bool is_number(const hive::Json& object, const char* key)
{
    const auto field = object.find(key);
    return field != object.end() && field->is_number();
}

double side(const hive::Json& header, const char* key)
{
    if (!is_number(header, key) || !(header[key].get<double>() > 0) || header[key].get<double>() > box_array::max_px)
        box_array::malformed("the header has no width and height of the image, so relative zones cannot be placed");
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

/// Only the fields of a track that are needed to draw it.
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
    const hive::Json& array =
        box_array::array_of_boxes(header, name.empty() && header.contains("tracks") ? "tracks" : name);
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
