// Converts between JSON and boxes, and checks what comes in.
#include "boxes.hpp"

#include <hive/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace track {
namespace {

/// px; what lies further away is in no picture, and squares of it stay exact enough.
constexpr double furthest = 1e6;
/// Of the colours of a box.
constexpr std::size_t most_numbers = 64;

bool is_box(const hive::Json& value)
{
    return value.is_object() && std::ranges::all_of(std::array{"x", "y", "w", "h"}, [&](const char* key) {
               const auto field = value.find(key);
               return field != value.end() && field->is_number();
           });
}

bool are_boxes(const hive::Json& value) { return value.is_array() && std::ranges::all_of(value, is_box); }

[[noreturn]] void malformed(const std::string& text) { throw hive::Error(hive::Errc::malformed, text); }

const hive::Json& only_array_of_boxes(const hive::Json& header)
{
    const hive::Json* found = nullptr;
    for (const auto& [key, value] : header.items())
        if (are_boxes(value)) {
            if (found)
                malformed("the header has several arrays of boxes; say which with the parameter `boxes`");
            found = &value;
        }
    if (!found)
        malformed("the header has no array of boxes: objects with the numbers x, y, w and h");
    return *found;
}

const hive::Json& array_of_boxes(const hive::Json& header, const std::string& name)
{
    if (name.empty())
        return only_array_of_boxes(header);
    const auto field = header.find(name);
    if (field == header.end() || !are_boxes(*field))
        malformed("the header has no array of boxes named " + hive::in_quotes(name));
    return *field;
}

/// What a finder tells of the colours in a box; what is anything else is not meant for the tracker.
Look look_in(const hive::Json& value)
{
    const auto field = value.find("colours");
    if (field == value.end() || !field->is_array() || field->size() > most_numbers)
        return {};
    std::vector<double> numbers;
    for (const hive::Json& part : *field) {
        if (!part.is_number() || !(part.get<double>() >= 0 && part.get<double>() <= furthest))
            return {};
        numbers.push_back(part);
    }
    return look_of(numbers);
}

Box checked(const hive::Json& value)
{
    Box box{value["x"], value["y"], value["w"], value["h"]};
    for (const double number : {box.x, box.y, box.w, box.h})
        if (!(std::abs(number) <= furthest))
            malformed("a box is further away than any picture reaches");
    if (!(box.w > 0 && box.h > 0))
        malformed("a box without area");
    if (const auto score = value.find("score"); score != value.end() && score->is_number())
        box.score = *score;
    box.look = look_in(value);
    return box;
}

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

}  // namespace

std::vector<Box> boxes_in(const hive::Json& header, const std::string& name)
{
    const hive::Json& array = array_of_boxes(header, name);
    if (array.size() > most_boxes)
        throw hive::Error(hive::Errc::too_large, "more than " + std::to_string(most_boxes) + " boxes in one picture");
    std::vector<Box> boxes;
    for (const hive::Json& value : array)
        boxes.push_back(checked(value));
    return boxes;
}

double number_in(const hive::Json& header, const char* key)
{
    const auto field = header.find(key);
    return field != header.end() && field->is_number() ? field->get<double>() : 0;
}

hive::Json to_json(const std::vector<Track>& tracks)
{
    const auto tenths = [](double value) { return rounded(value, 10); };
    hive::Json array = hive::Json::array();
    for (const Track& one : tracks)
        array.push_back({{"id", one.id},
                         {"x", tenths(one.box.x)},
                         {"y", tenths(one.box.y)},
                         {"w", tenths(one.box.w)},
                         {"h", tenths(one.box.h)},
                         {"vx", tenths(one.speed_x)},
                         {"vy", tenths(one.speed_y)},
                         {"speed", tenths(std::hypot(one.speed_x, one.speed_y))},
                         {"age", one.age},
                         {"seconds", rounded(one.seconds, 1000)},
                         {"hits", one.hits},
                         {"missing", one.missing},
                         {"confirmed", one.confirmed}});
    return array;
}

}  // namespace track
