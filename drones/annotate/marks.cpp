// The JSON is untrusted, so invalid marks are ignored.
#include "marks.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace annotate {
namespace {

using nlohmann::json;

constexpr double largest = 1e6;  // px; no image comes near
constexpr std::size_t longest_label = 48;
constexpr double min_score = 0.5;  ///< of a point

std::optional<double> number(const json& object, const char* key)
{
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number())
        return std::nullopt;
    const auto value = found->get<double>();
    return std::abs(value) <= largest ? std::optional(value) : std::nullopt;
}

/// A text, or a whole number as one; empty for anything else.
std::string text(const json& object, const char* key)
{
    const auto found = object.find(key);
    if (found == object.end())
        return {};
    if (found->is_number_integer())
        return found->dump();
    return found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<cv::Point2d> point(const json& value)
{
    if (value.is_array() && (value.size() == 2 || value.size() == 3))
        return point(json{{"x", value[0]}, {"y", value[1]}});
    if (!value.is_object())
        return std::nullopt;
    const auto x = number(value, "x"), y = number(value, "y");
    return x && y ? std::optional(cv::Point2d(*x, *y)) : std::nullopt;
}

/// A network that returns all keypoints marks the visible ones by their score.
bool is_unseen(const json& point)
{
    return point.is_array() && point.size() == 3 && point[2].is_number() && point[2].get<double>() < min_score;
}

Shape::Form form_of(const std::string& name)
{
    using enum Shape::Form;
    if (name == "trail")
        return line;
    if (name == "mask")
        return area;
    return name == "hull" || name == "contour" || name == "corners" ? outline : dots;
}

std::optional<Shape> shape(const std::string& name, const json& values)
{
    if (!values.is_array() || values.empty())
        return std::nullopt;
    Shape shape{form_of(name), {}};
    for (const auto& value : values) {
        const auto place = point(value);
        if (!place)
            return std::nullopt;
        if (!is_unseen(value))
            shape.points.push_back(*place);
    }
    return shape;
}

/// OpenCV's letters are ASCII.
std::string printable(std::string label)
{
    label.resize(std::min(label.size(), longest_label));
    for (char& letter : label)
        if (letter < ' ' || letter > '~')
            letter = '?';
    return label;
}

std::string label_of(const json& object, const std::string& id)
{
    std::string label;
    const auto add = [&](const std::string& word) { label += (label.empty() || word.empty() ? "" : " ") + word; };
    for (const char* key : {"class", "kind", "gesture", "pose", "label"})
        add(text(object, key));
    add(id.empty() ? "" : "#" + id);
    if (const auto score = number(object, "score"); score && *score >= 0 && *score <= 1)
        add(std::to_string(std::lround(100 * *score)) + " %");
    if (const auto speed = number(object, "speed"))
        add(std::to_string(std::lround(*speed)) + " px/s");
    return printable(label);
}

bool is_uncertain(const json& object)
{
    const auto confirmed = object.find("confirmed");
    return number(object, "missing").value_or(0) > 0
           || (confirmed != object.end() && confirmed->is_boolean() && !confirmed->get<bool>());
}

std::string label_of_region(const json& object)
{
    std::string label = text(object, "name");
    for (const auto& [key, word] : {std::pair{"occupancy", " "}, {"in", " in "}, {"out", " out "}})
        if (const auto count = text(object, key); !count.empty())
            label += word + count;
    return printable(label);
}

bool is_share(const cv::Point2d& point) { return point.x >= 0 && point.x <= 1 && point.y >= 0 && point.y <= 1; }

void add_regions(const json& header, const char* field, bool closed, std::vector<Region>& regions)
{
    const auto array = header.find(field);
    if (array == header.end() || !array->is_array())
        return;
    for (const auto& object : *array) {
        const auto points = object.is_object() ? object.find("points") : object.end();
        const auto found = points != object.end() ? shape("points", *points) : std::nullopt;
        if (found && found->points.size() >= (closed ? 3 : 2) && std::ranges::all_of(found->points, is_share))
            regions.push_back({found->points, label_of_region(object), closed});
    }
}

std::optional<Mark> mark(const json& object)
{
    if (!object.is_object())
        return std::nullopt;
    const auto x = number(object, "x"), y = number(object, "y"), width = number(object, "w"),
               height = number(object, "h");
    if (!x || !y || !width || !height)
        return std::nullopt;
    const auto id = text(object, "id");
    Mark mark{{*x, *y, *width, *height}, id.empty() ? text(object, "class") : id, label_of(object, id), {}};
    mark.uncertain = is_uncertain(object);
    for (const auto& [name, value] : object.items())
        if (auto found = shape(name, value)) {
            mark.framed = mark.framed && name != "corners";
            mark.shapes.push_back(std::move(*found));
        }
    return mark;
}

}  // namespace

Marks marks_in(const json& header)
{
    Marks marks;
    if (!header.is_object())
        return marks;
    if (const auto width = number(header, "width"), height = number(header, "height");
        width && height && *width > 0 && *height > 0)
        marks.seen = {*width, *height};
    const auto take = [&](const json& value) {
        if (auto found = mark(value))
            marks.all.push_back(std::move(*found));
    };
    add_regions(header, "zones", true, marks.regions);
    add_regions(header, "lines", false, marks.regions);
    for (const auto& field : header)
        if (field.is_array())
            for (const auto& value : field)
                take(value);
        else
            take(field);
    return marks;
}

}  // namespace annotate
