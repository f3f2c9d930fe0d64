// A hand drawn from a disc and thick lines, which shows a number of fingers.
#pragma once

#include <opencv2/core/mat.hpp>

namespace camera {

/// The drawn hand, which is also the ground truth.
struct DrawnHand {
    cv::Point2d palm;     ///< its centre, px
    double radius = 45;   ///< of the palm, px
    int fingers = 5;      ///< 0, a fist, to 5
    double rotation = 0;  ///< degrees clockwise; 0: fingers up, arm down
    double arm = 1.9;     ///< its length below the centre of the palm, in radii

    bool operator==(const DrawnHand&) const = default;
};

/// Draws the hand in skin colour into a BGR image. Fingers reach 2.55 radii from the centre, a thumb 1.95. What lies
/// outside the image is cut off.
void draw_hand(cv::Mat& image, const DrawnHand& hand);

}  // namespace camera
