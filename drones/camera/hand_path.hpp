// Computes where the hand of the scene is and how many fingers it shows.
#pragma once

#include "drawn_hand.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace camera {

/// Shows each for this many frames, repeatedly: first no hand, so that a background can be learned.
inline constexpr int frames_per_gesture = 30;
inline constexpr int no_hand = -1;
inline constexpr std::array fingers_shown{no_hand, 5, 2, 1, 4, 0, 3};

/// The hand moves slowly, fingers wholly inside an image of `size`; its arm reaches the lower border.
std::optional<DrawnHand> hand_at(std::int64_t index, cv::Size size);

}  // namespace camera
