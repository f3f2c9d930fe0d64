// What can be known of a PNG from its chunks (W3C PNG, third edition), before any memory is spent on its pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace hive::vision {

/// What stands in the first chunk, IHDR. Nothing is checked but that there is a picture of some size.
struct PngHeader {
    std::int64_t width = 0, height = 0;  ///< 1 to 2^31 - 1
    int depth = 0;                       ///< bits of a sample
    int color = 0, compression = 0, filter = 0, interlace = 0;
};

/// Throws Errc::malformed when the bytes do not begin with a signature and a header.
PngHeader png_header(std::span<const std::uint8_t> bytes);

/// The same PNG with nothing in it but what the picture needs: header, palette, transparency, pixels, EXIF. Texts and
/// colour profiles, which a decoder would inflate, are left out unread. The pixels are inflated once here, without
/// keeping them, and no further than the header says they go. Throws Errc::malformed when the chunks do not fit
/// together, are damaged or cut short, or hold more or fewer bytes than the pixels are.
std::vector<std::uint8_t> only_the_picture(std::span<const std::uint8_t> bytes, const PngHeader& header);

}  // namespace hive::vision
