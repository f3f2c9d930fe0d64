// The colour of a person's skin, learned from pixels of skin. Plain OpenCV.
#pragma once

#include <opencv2/core/mat.hpp>

#include <optional>

namespace gesture {

/// A normal distribution in YCrCb.
class SkinColour {
public:
    /// The minimum standard deviations that are assumed: brightness, and both differences of colour, in levels.
    struct Spread {
        double brightness, colour;
    };

    /// From the pixels of a BGR image where `where` (8 bit, its size) is not 0; nothing if there are fewer than 20. A
    /// third of them may be something else (eyes, hair, a beard): pixels far from the median are ignored.
    static std::optional<SkinColour> learn(const cv::Mat& image, const cv::Mat& where, Spread least);

    /// How far another skin's mean is from this one, in standard deviations.
    [[nodiscard]] double distance(const SkinColour& other) const;

    /// 255 where a pixel of a BGR image is within this many standard deviations, else 0.
    [[nodiscard]] cv::Mat mask(const cv::Mat& image, double deviations) const;

private:
    cv::Vec3d mean_;
    cv::Matx33d inverse_;  ///< of the covariance
};

}  // namespace gesture
