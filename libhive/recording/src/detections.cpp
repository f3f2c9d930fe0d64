// Headers are untrusted: whatever is not a box is not a detection.
#include <hive/error.hpp>
#include <hive/recording/detections.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace hive::recording {
namespace {

constexpr double max_px = 1e6;

std::optional<double> number(const Json& object, const char* key)
{
    const auto field = object.find(key);
    return field != object.end() && field->is_number() ? std::optional(field->get<double>()) : std::nullopt;
}

std::optional<std::int64_t> integer(const Json& object, const char* key)
{
    const auto field = object.find(key);
    return field != object.end() && field->is_number_integer() ? std::optional(field->get<std::int64_t>())
                                                               : std::nullopt;
}

bool is_box(const Json& value)
{
    if (!value.is_object())
        return false;
    for (const char* key : {"x", "y", "w", "h"})
        if (!(std::abs(number(value, key).value_or(INFINITY)) <= max_px))
            return false;
    return *number(value, "w") > 0 && *number(value, "h") > 0;
}

Detection detection_of(const Json& box, const std::string& kind)
{
    Detection one{*number(box, "x"), *number(box, "y"), *number(box, "w"), *number(box, "h"), kind};
    if (const auto found = box.find("class"); found != box.end() && found->is_string())
        one.category = found->get<std::string>();
    one.id = integer(box, "id");
    one.score = number(box, "score");
    one.missing = integer(box, "missing");
    if (const auto found = box.find("confirmed"); found != box.end() && found->is_boolean())
        one.confirmed = found->get<bool>();
    return one;
}

/// A name from another machine must not lead to another folder or be hidden.
std::string safe(std::string name)
{
    for (char& letter : name)
        if (const auto byte = static_cast<unsigned char>(letter);
            byte < 128 && !std::isalnum(byte) && letter != '-' && letter != '.' && letter != '_')
            letter = '_';
    return name.empty() || name[0] == '.' ? "_" + name : name;
}

bool is_image(std::string extension)
{
    std::ranges::transform(extension, extension.begin(), [](unsigned char letter) { return std::tolower(letter); });
    const std::array images{".jpg", ".jpeg", ".png", ".bmp", ".tif", ".tiff", ".webp", ".pgm", ".ppm"};
    return std::ranges::count(images, extension) > 0;
}

std::string name_of(const Event& event)
{
    std::string stem = event.identity.source;
    if (const auto file = event.header.find("file"); file != event.header.end() && file->is_string()) {
        const std::filesystem::path path(file->get<std::string>());
        if (is_image(path.extension().string()))
            return safe(path.filename().string());
        stem = path.stem().string();
    }
    char digits[32];
    std::snprintf(digits, sizeof digits, "_%08lld.jpg", static_cast<long long>(event.identity.sequence));
    return safe(stem) + digits;
}

}  // namespace

DetectedImage detections_in(const Event& event)
{
    DetectedImage image{name_of(event), event.identity.source, event.sender, event.output};
    image.epoch = event.identity.epoch;
    image.sequence = event.identity.sequence;
    image.captured_us = event.identity.captured_us;
    image.media_time_us = integer(event.header, "media_time_us");
    image.width = std::max<std::int64_t>(0, integer(event.header, "width").value_or(0));
    image.height = std::max<std::int64_t>(0, integer(event.header, "height").value_or(0));
    bool found = false;
    for (const Json& field : event.header)
        if (field.is_array() && std::ranges::all_of(field, is_box)) {
            found = true;
            for (const Json& box : field)
                image.detections.push_back(detection_of(box, event.kind));
        }
    if (!found)
        throw Error(Errc::refused, event.sender + "." + event.output
                                       + " has no boxes: no field of its header is an array of objects with x, y, w "
                                         "and h");
    return image;
}

}  // namespace hive::recording
