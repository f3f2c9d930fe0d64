// Finds upright people with histograms of oriented gradients (Dalal and Triggs) and OpenCV's trained classifier.
#pragma once

#include "object.hpp"

#include <opencv2/objdetect.hpp>

#include <vector>

namespace detect {

class PeopleFinder {
public:
    double hit_threshold = 0;  ///< minimum margin of a window: a higher one finds fewer, with fewer false ones
    double enlarge = 1;        ///< the image, 1 to 4 times: people must be at least 96 px high in the enlarged image
    double scale = 1.05;       ///< step between image scales, 1.01 to 2
    int stride = 8;            ///< between windows, px: a multiple of 4
    int padding = 16;          ///< around the image, px, so that people at its border are seen
    int grouping = 2;          ///< windows that must agree; 0: every window is an object
    bool shrink = true;        ///< the classifier's windows have a margin around the person; take it off the boxes

    PeopleFinder();
    /// @param image  8 bit, BGR or grey; not changed
    [[nodiscard]] std::vector<Object> find(const cv::Mat& image) const;

private:
    /// Maps a window in the enlarged image to a box in the image.
    [[nodiscard]] cv::Rect in_image(const cv::Rect& window) const;

    cv::HOGDescriptor descriptor_;
};

}  // namespace detect
