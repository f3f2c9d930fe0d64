#include "shapes.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace zones {
namespace {

constexpr double min_area = 1e-6;  // of the image: less than a pixel of 1000 x 1000

[[noreturn]] void refuse(const std::string& text) { throw std::invalid_argument(text); }

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

std::string trimmed(const std::string& text)
{
    const auto first = text.find_first_not_of(" \t\n"), last = text.find_last_not_of(" \t\n");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::optional<double> number(const std::string& text)
{
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

Point point_of(const std::string& word, const std::string& of)
{
    const auto comma = word.find(',');
    const auto x = number(word.substr(0, comma)),
               y = comma == std::string::npos ? std::nullopt : number(word.substr(comma + 1));
    if (!x || !y)
        refuse(of + ": " + quoted(word) + " is not a point; write X,Y with a space between points");
    for (const double value : {*x, *y})
        if (!(value >= 0 && value <= 1))
            refuse(of + ": " + quoted(word)
                   + " is outside 0 to 1; coordinates are shares of the image: divide px by its width and height");
    return {*x, *y};
}

std::string checked_name(const std::string& name)
{
    const auto allowed = [](unsigned char letter) {
        return std::isalnum(letter) || letter == '_' || letter == '-' || letter == '.';
    };
    if (name.empty() || name.size() > max_name || !std::ranges::all_of(name, allowed))
        refuse(quoted(name) + " is not a name: 1 to 32 letters, digits, '_', '-' or '.'");
    return name;
}

Shape shape_of(const std::string& part)
{
    const auto colon = part.find(':');
    if (colon == std::string::npos)
        refuse(quoted(part) + " has no name; write NAME: X,Y X,Y ...");
    Shape shape{checked_name(trimmed(part.substr(0, colon))), {}};
    std::istringstream words(part.substr(colon + 1));
    for (std::string word; words >> word;) {
        shape.points.push_back(point_of(word, shape.name));
        if (shape.points.size() > max_points)
            refuse(shape.name + ": more than 32 points");
    }
    return shape;
}

void add(std::vector<Shape>& shapes, Shape shape)
{
    if (std::ranges::count(shapes, shape.name, &Shape::name) > 0)
        refuse(shape.name + ": duplicate name");
    shapes.push_back(std::move(shape));
    if (shapes.size() > max_shapes)
        refuse("more than 16");
}

/// Parts are separated by semicolons; one at the end is allowed.
std::vector<Shape> read(const std::string& text, void (*check)(const Shape&))
{
    std::vector<Shape> shapes;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ';');)
        if (const auto bare = trimmed(part); !bare.empty()) {
            const Shape shape = shape_of(bare);
            check(shape);
            add(shapes, shape);
        }
    return shapes;
}

void check_polygon(const Shape& shape)
{
    if (shape.points.size() < 3)
        refuse(shape.name + ": " + std::to_string(shape.points.size()) + " points; a zone needs at least 3");
    for (std::size_t i = 0; i < shape.points.size(); ++i)
        if (shape.points[i] == shape.points[(i + 1) % shape.points.size()])
            refuse(shape.name + ": the same point twice in a row; the last side closes by itself");
    if (crosses_itself(shape.points))
        refuse(shape.name + ": two of its sides cross; list the corners in the order of the outline");
    if (area(shape.points) < min_area)
        refuse(shape.name + ": no area");
}

void check_line(const Shape& shape)
{
    if (shape.points.size() != 2)
        refuse(shape.name + ": " + std::to_string(shape.points.size()) + " points; a line needs 2");
    if (shape.points[0] == shape.points[1])
        refuse(shape.name + ": no length");
}

}  // namespace

std::vector<Shape> read_zones(const std::string& text) { return read(text, check_polygon); }

std::vector<Shape> read_lines(const std::string& text) { return read(text, check_line); }

}  // namespace zones
