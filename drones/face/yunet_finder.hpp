// Finds faces with YuNet, a small network, from an ONNX file, through OpenCV's FaceDetectorYN. Plain OpenCV.
#pragma once

#include <opencv2/dnn.hpp>
#include <opencv2/objdetect/face.hpp>

#include <array>
#include <string>
#include <vector>

namespace face {

struct Face {
    cv::Rect box;      ///< px, within the image
    double score = 0;  ///< 0 to 1
    std::array<cv::Point2f, 5>
        points{};  ///< px: right eye, left eye, tip of the nose, right and left corner of the mouth
};

class YunetFinder {
public:
    double min_score = 0.8, overlap = 0.3;
    static constexpr std::size_t max_faces = 200;  ///< of one image; the best

    /// Reads the file. @throws std::runtime_error  a sentence about what is wrong
    explicit YunetFinder(const std::string& path);

    /// @param image  8 bit, BGR or grey; not changed
    /// @return  from top to bottom, then from left to right
    /// @throws std::runtime_error  the outputs for an image of this size are not those of a YuNet
    [[nodiscard]] std::vector<Face> find(const cv::Mat& image);

private:
    void prepare(cv::Size size);

    std::string path_;
    cv::dnn::Net net_;  ///< to check the model's outputs before the detector uses them
    cv::Ptr<cv::FaceDetectorYN> detector_;
    cv::Size size_;  ///< that it is prepared for
};

}  // namespace face
