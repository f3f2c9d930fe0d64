// What can be known of a PNG from its chunks (W3C PNG, third edition), before any memory is spent on its pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace hive::vision {

/// 1 to 2^31 - 1 each.
struct PngSize {
    std::int64_t width = 0, height = 0;
};
/// What stands in the first chunk. Throws Errc::malformed when the bytes do not begin with a signature and a header.
PngSize png_size(std::span<const std::uint8_t> bytes);

/// A PNG without all that its picture does not need.
struct PngStructure {
    std::vector<std::uint8_t> bytes;  ///< header, palette, transparency and pixels
    int orientation = 1;              ///< of EXIF, 1 to 8; 1 is upright
};
/// Walks the chunks from the first to the last. Texts and colour profiles, which a decoder would inflate, are left out
/// unread. Throws Errc::malformed when the chunks do not fit together or the end is missing.
PngStructure png_structure(std::span<const std::uint8_t> bytes);

}  // namespace hive::vision
