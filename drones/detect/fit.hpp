// Fits images into a network's input, and maps coordinates back to the image.
#pragma once

#include <opencv2/core/mat.hpp>

namespace detect {

class Fit {
public:
    enum class Kind {
        letterbox,  ///< whole, its shape kept, with grey margins
        stretch,    ///< whole, its shape lost
        crop        ///< the middle, its shape kept
    };

    /// @param picture, input  sizes in px, not empty
    Fit(cv::Size picture, cv::Size input, Kind kind);

    /// @param picture  8 bit, BGR or grey; not changed
    [[nodiscard]] cv::Mat input_from(const cv::Mat& picture) const;
    [[nodiscard]] cv::Point2d in_picture(const cv::Point2d& in_input) const;
    [[nodiscard]] cv::Rect2d in_picture(const cv::Rect2d& in_input) const;

private:
    cv::Size picture_, input_;
    cv::Point2d scale_, offset_;  ///< from px of the image to px of the input
};

}  // namespace detect
