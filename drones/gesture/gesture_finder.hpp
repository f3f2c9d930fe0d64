// Reads hands from a silhouette: palm, extended fingers, direction. The algorithm of the gesture drone, plain OpenCV.
#pragma once

#include "hand.hpp"

#include <opencv2/core/mat.hpp>

#include <optional>
#include <vector>

namespace gesture {

/// The palm is the largest disc inside the silhouette. The outline is cut where it comes near that disc and at the deep
/// convexity defects between fingers; a narrow piece that reaches far enough is a finger, a wide one is the arm.
class GestureFinder {
public:
    int max_hands = 1;      ///< number of silhouettes to read, the largest first
    int smooth = 5;         ///< narrower specks, hairs and gaps of the silhouette are ignored, px; 0: none
    double min_area = 0.5;  ///< of the smallest silhouette, % of the image

    /// @param silhouette  8 bit, one channel, not 0 in the silhouette; not changed
    /// @return  the largest first; any silhouette is read as a hand
    [[nodiscard]] std::vector<Hand> find(const cv::Mat& silhouette) const;

    struct Read {
        Hand hand;
        int arms;  ///< pieces of the outline that are too wide for a finger and go far: of a hand one, or none
    };
    /// Reads the part of the silhouette that covers a place, whose palm is there and about so large; nothing if none
    /// does.
    [[nodiscard]] std::optional<Read> read_at(const cv::Mat& silhouette, cv::Point place, double radius) const;
};

}  // namespace gesture
