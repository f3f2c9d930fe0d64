// A hand, as it is read from its silhouette.
#pragma once

#include <opencv2/core/mat.hpp>

#include <optional>
#include <string_view>
#include <vector>

namespace gesture {

struct Hand {
    cv::Rect box;                 ///< of the whole silhouette, with what is seen of the arm, px
    cv::Point palm;               ///< centre of the largest disc inside it
    double radius = 0;            ///< of that disc, px
    std::vector<cv::Point> tips;  ///< of the extended fingers, clockwise from the arm; at most 5
    std::optional<double>
        angle;  ///< direction of the hand, degrees clockwise from upwards, above -180 to 180; none if unknown
};

/// The pose: fist, one, two, three, four, open.
std::string_view pose(const Hand& hand);
/// Outlines boxes and palms, and marks the fingers, in a BGR image.
void draw(cv::Mat& image, const std::vector<Hand>& hands);

}  // namespace gesture
