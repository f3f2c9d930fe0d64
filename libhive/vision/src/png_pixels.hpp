// The pixels of a PNG, by libpng.
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <span>

namespace hive::vision {

/// Fills `picture`, 8 bit BGR of the size that the header says. Inflates what the pixels need and hardly more, whatever
/// else is there. Throws Errc::malformed when the bytes are damaged or too few.
/// @param bytes  of png_structure()
void read_png(std::span<const std::uint8_t> bytes, cv::Mat& picture);

}  // namespace hive::vision
