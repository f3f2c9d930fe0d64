// Reads and writes the pixels of a PNG with libpng.
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace hive::vision {

struct PngSize {
    std::int64_t width = 0, height = 0;
};
/// Reads the part before the pixels, and inflates nothing. Throws Errc::malformed if it is damaged or truncated.
PngSize png_size(std::span<const std::uint8_t> bytes);

/// Fills `image`, 8 bit BGR of the size in the header. Inflates little more than the pixels: texts and colour
/// profiles are skipped. Throws Errc::malformed if any byte is damaged or missing, up to the chunk that ends the file.
/// @return  the orientation of EXIF, 1 to 8; 1 is upright
int read_png(std::span<const std::uint8_t> bytes, cv::Mat& image);

/// A PNG of the same channels and bits. Throws Errc::failed if libpng refuses.
/// @param image  8 bit with 1 or 3 (BGR) channels, or 16 bit grey
std::vector<unsigned char> write_png(const cv::Mat& image);

}  // namespace hive::vision
