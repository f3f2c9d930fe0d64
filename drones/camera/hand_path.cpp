// The hand swings slowly in place, size and angle, with periods that have no common multiple.
#include "hand_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace camera {
namespace {

/// Between -1 and 1, once in `period` images.
double swing(std::int64_t index, int period)
{
    return std::sin(2 * std::numbers::pi * static_cast<double>(index % period) / period);
}

}  // namespace

std::optional<DrawnHand> hand_at(std::int64_t index, cv::Size size)
{
    const int fingers = fingers_shown[static_cast<std::size_t>(index / frames_per_gesture) % fingers_shown.size()];
    if (fingers == no_hand)
        return std::nullopt;
    const double radius = std::min(size.width, size.height) * (0.1 + 0.02 * swing(index, 151));
    const double reach = 2.7 * radius;  // of the fingers from the centre of the palm, and a little
    const cv::Point2d middle(size.width * 0.5, size.height * 0.5);
    return DrawnHand{
        .palm = {middle.x + (middle.x - reach) * swing(index, 173), middle.y + (middle.y - reach) * swing(index, 113)},
        .radius = radius,
        .fingers = fingers,
        .rotation = 15 * swing(index, 89),
        .arm = static_cast<double>(size.height) / radius};
}

}  // namespace camera
