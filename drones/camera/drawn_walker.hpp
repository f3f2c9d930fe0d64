// A walking person drawn from lines and ellipses: people detectors detect it as a real one in front of a wall that is
// lighter than its clothes.
#pragma once

#include <opencv2/core/mat.hpp>

namespace camera {

/// Where a walker is in one image, px.
struct Walker {
    double middle;  ///< x
    double top;     ///< y of the head's top
    double height;
    double phase;  ///< of the step, radians: the legs are together at 0 and furthest apart a quarter of a turn later

    /// From head to feet, as wide as people detectors frame it: hands and feet of large steps reach a little beyond.
    [[nodiscard]] cv::Rect2d box() const { return {middle - 0.17 * height, top, 0.34 * height, height}; }
    bool operator==(const Walker&) const = default;
};

/// Draws into a BGR image. What lies outside of it is cut off.
void draw_walker(cv::Mat& image, const Walker& walker);

}  // namespace camera
