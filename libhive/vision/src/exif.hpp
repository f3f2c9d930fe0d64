// The orientation of an image by its EXIF data.
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <span>

namespace hive::vision {

/// The orientation tag (0x0112) of an APP1 segment: 1 to 8; 1 (upright) if it is missing or invalid.
int exif_orientation(std::span<const std::uint8_t> app1) noexcept;

/// `image` turned and mirrored so that it stands upright.
cv::Mat upright(const cv::Mat& image, int orientation);

/// Does the orientation exchange width and height?
inline bool lies_on_its_side(int orientation) noexcept { return orientation >= 5; }

}  // namespace hive::vision
