// Tests of raw pixels as PNG, read back by libpng.
#include "words/raw_image.hpp"

#include <hive/error.hpp>

#include <doctest/doctest.h>

#include <png.h>

using namespace hivectl;
using hive::Json;

TEST_CASE("raw image: the PNG has the pixels, whatever stands between the rows")
{
    const auto png = png_of(Json{{"width", 1}, {"height", 2}, {"pixel_format", "bgr8"}, {"stride", 4}},
                            hive::Body(std::string("\x01\x02\x03?\x04\x05\x06?")));
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_memory(&image, png.data(), png.size()) != 0);
    CHECK(image.width == 1);
    CHECK(image.height == 2);
    image.format = PNG_FORMAT_RGB;
    std::string pixels(PNG_IMAGE_SIZE(image), '\0');
    REQUIRE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) != 0);
    CHECK(pixels == "\x03\x02\x01\x06\x05\x04");
}

TEST_CASE("raw image: what cannot be a PNG, or lies about its size, is refused")
{
    const auto code = [](const Json& header, const std::string& pixels) {
        try {
            png_of(header, hive::Body(pixels));
        } catch (const hive::Error& error) {
            return error.code();
        }
        return hive::Errc::io;
    };
    CHECK(code({{"width", 1}, {"height", 1}, {"pixel_format", "gray32f"}}, "1234") == hive::Errc::unsupported);
    CHECK(code({{"width", 2}, {"height", 2}, {"pixel_format", "gray8"}}, "123") == hive::Errc::malformed);
    CHECK(code({{"width", 2}, {"height", 2}, {"pixel_format", "gray8"}, {"stride", 1}}, "12") != hive::Errc::io);
}
