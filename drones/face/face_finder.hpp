// Finds frontal faces with a Haar cascade: the algorithm of the face drone, plain OpenCV.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/objdetect.hpp>

#include <string>
#include <vector>

namespace face {

/// The path of OpenCV's cascade in Debian (package opencv-data).
inline constexpr const char* default_cascade = "/usr/share/opencv4/haarcascades/haarcascade_frontalface_default.xml";

class FaceFinder {
public:
    double scale = 1.1;     ///< step between image scales, 1.01 to 2: smaller finds more and takes longer
    int min_neighbors = 5;  ///< detections that must agree on a face
    int min_size = 24;      ///< side of the smallest face, px
    int max_size = 0;       ///< side of the largest face, px; 0: no limit
    bool equalise = false;  ///< spread the grey levels first

    /// Throws std::runtime_error naming the missing file.
    void load(const std::string& cascade_path);
    /// @param image  8 bit, BGR or grey; not changed
    /// @return  boxes in px, from top to bottom, then from left to right
    [[nodiscard]] std::vector<cv::Rect> find(const cv::Mat& image);
    /// Frames the faces in `image`.
    static void draw(cv::Mat& image, const std::vector<cv::Rect>& faces);

private:
    cv::CascadeClassifier cascade_;
};

}  // namespace face
