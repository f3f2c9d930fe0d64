// Computes the paths of the people who cross the synthetic scene, one after the other on each of a few lanes.
#pragma once

#include "drawn_walker.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace camera {

/// One of the people in an image.
struct Passer {
    int id;  ///< from 1, unique in the scene
    Walker walker;
};

/// Each lane has a speed, a direction and a distance of its own; each person on it a height. The first second is empty,
/// so that a background can be learned. Depends on its arguments alone.
class Walkers {
public:
    static constexpr int most = 4;

    /// @param lanes  0 to most
    Walkers(int lanes, cv::Size size, std::uint64_t seed) : lanes_(lanes), size_(size), seed_(seed) {}

    /// The people of an image, those further away first; some may be outside of it.
    [[nodiscard]] std::vector<Passer> at(std::int64_t index) const;

private:
    [[nodiscard]] std::optional<Passer> on_lane(int lane, std::int64_t index) const;

    int lanes_;
    cv::Size size_;
    std::uint64_t seed_;
};

/// The part of a walker's box that lies in an image of `size`, if that is at least half of it.
std::optional<cv::Rect2d> visible_box(const Walker& walker, cv::Size size);

}  // namespace camera
