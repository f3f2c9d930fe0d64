// The wall behind the synthetic scene.
#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>

namespace camera {

enum class Background { brick, noise, plain };

/// A BGR image of `size`, the same for the same arguments: a brick wall, soft colourful noise, or one grey.
cv::Mat draw_background(Background background, cv::Size size, std::uint64_t seed);

}  // namespace camera
