#include "words/raw_image.hpp"

#include <hive/error.hpp>

#include <png.h>

#include <map>

namespace hivectl {
namespace {

struct Format {
    png_uint_32 png;
    std::int64_t channels;
};

Format format_of(const std::string& pixels)
{
    static const std::map<std::string_view, Format> formats{
        {"gray8", {PNG_FORMAT_GRAY, 1}}, {"bgr8", {PNG_FORMAT_BGR, 3}}, {"bgra8", {PNG_FORMAT_BGRA, 4}}};
    const auto found = formats.find(pixels);
    if (found == formats.end())
        throw hive::Error(hive::Errc::unsupported,
                          "pixels of the format " + hive::in_quotes(pixels) + " cannot be saved as PNG",
                          "let the drone emit gray8, bgr8 or bgra8");
    return found->second;
}

}  // namespace

hive::Body png_of(const hive::Json& header, const hive::Body& pixels)
{
    constexpr std::int64_t max_side = 1 << 20;
    const hive::Fields fields(header, "the header of image/raw");
    const auto format = format_of(fields.text("pixel_format"));
    const auto width = fields.integer("width", 1, max_side), height = fields.integer("height", 1, max_side);
    const auto row = width * format.channels;
    const auto stride = fields.integer_or("stride", row, 1 << 30, row);
    if (static_cast<std::int64_t>(pixels.size()) != stride * height)
        throw hive::Error(hive::Errc::malformed, "the body of image/raw does not have the size in its header");
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = format.png;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::string png(size, '\0');
    if (png_image_write_to_memory(&image, png.data(), &size, 0, pixels.data(), static_cast<png_int_32>(stride), nullptr)
        == 0)
        throw hive::Error(hive::Errc::failed, std::string("libpng: ") + image.message);
    png.resize(size);
    return hive::Body(std::move(png));
}

}  // namespace hivectl
