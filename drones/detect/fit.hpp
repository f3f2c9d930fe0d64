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

    /// @param image, input  sizes in px, not empty
    Fit(cv::Size image, cv::Size input, Kind kind);

    /// @param image  8 bit, BGR or grey; not changed
    [[nodiscard]] cv::Mat input_from(const cv::Mat& image) const;
    [[nodiscard]] cv::Point2d in_image(const cv::Point2d& in_input) const;
    [[nodiscard]] cv::Rect2d in_image(const cv::Rect2d& in_input) const;

private:
    cv::Size image_, input_;
    cv::Point2d scale_, offset_;  ///< from px of the image to px of the input
};

}  // namespace detect
