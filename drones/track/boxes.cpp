// Converts between JSON and boxes, and checks the input.
#include "boxes.hpp"

#include <box_array.hpp>

#include <cmath>

namespace track {
namespace {

/// Of the colours of a box.
constexpr std::size_t max_numbers = 64;

/// The colours that a finder reports for a box; any other value is ignored.
Look look_in(const hive::Json& value)
{
    const auto field = value.find("colours");
    if (field == value.end() || !field->is_array() || field->size() > max_numbers)
        return {};
    std::vector<double> numbers;
    for (const hive::Json& part : *field) {
        if (!part.is_number() || !(part.get<double>() >= 0 && part.get<double>() <= box_array::max_px))
            return {};
        numbers.push_back(part);
    }
    return look_of(numbers);
}

Box checked(const hive::Json& value)
{
    Box box{value["x"], value["y"], value["w"], value["h"]};
    if (!(box.w > 0 && box.h > 0))
        box_array::malformed("a box without area");
    if (const auto score = value.find("score"); score != value.end() && score->is_number())
        box.score = *score;
    box.look = look_in(value);
    return box;
}

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

}  // namespace

std::vector<Box> boxes_in(const hive::Json& header, const std::string& name)
{
    const hive::Json& array = box_array::array_of_boxes(header, name);
    if (array.size() > max_boxes)
        throw hive::Error(hive::Errc::too_large, "more than " + std::to_string(max_boxes) + " boxes in one image");
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
