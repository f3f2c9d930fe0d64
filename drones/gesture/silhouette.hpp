// Makes the silhouette: from a mask as it is, or from the skin-coloured parts of an image.
#pragma once

#include <opencv2/core/mat.hpp>

#include <string>

namespace gesture {

/// Skin in YCrCb: brightness and two differences of colour, each 0 to 255, both ends included.
struct SkinRange {
    int y_min = 30, y_max = 255;
    int cr_min = 138, cr_max = 175;
    int cb_min = 80, cb_max = 127;
};

class Silhouette {
public:
    std::string from = "mask";  ///< "mask": the image itself; "skin": its skin-coloured parts
    int level = 1;              ///< of a mask: grey level from which on it is silhouette, 1 to 255
    SkinRange skin;

    /// @param image  8 bit, BGR or grey; not changed
    /// @return  grey, 255 in the silhouette and 0 elsewhere. A grey image has no skin
    [[nodiscard]] cv::Mat of(const cv::Mat& image) const;
};

}  // namespace gesture
