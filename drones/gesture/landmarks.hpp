// Reads a hand by 21 landmarks that a network finds in it, for users who have such a model. Plain OpenCV.
#pragma once

#include "hand.hpp"

#include <opencv2/dnn.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace gesture {

/// The joints in MediaPipe's order: wrist, then four from the palm to the tip for thumb, index, middle, ring and little
/// finger. Of any unit.
using Joints = std::array<cv::Point2d, 21>;

/// The tips of the fingers that are extended: of a finger whose tip is clearly further from the wrist than its middle
/// joint, of the thumb further from the little finger's root than its own middle joint.
std::vector<cv::Point2d> extended_tips(const Joints& joints);

/// A model in the form of MediaPipe's hand landmarks: input of 224x224 px, RGB from 0 to 1; outputs, in this order
/// among others of other sizes: 63 numbers (x, y and depth of each joint, in px of the input), and 1 number, how sure
/// it is that this is a hand.
class HandLandmarks {
public:
    static constexpr double least_presence = 0.5;

    /// Reads the file and runs it once. @throws std::runtime_error  with the reason as a sentence
    explicit HandLandmarks(const std::string& path);

    /// Reads the hand again, around its palm and turned upright; nothing if the network sees no hand there.
    /// @param picture  8 bit, BGR
    [[nodiscard]] std::optional<Hand> read(const cv::Mat& picture, const Hand& hand);

private:
    [[nodiscard]] std::vector<cv::Mat> run(const cv::Mat& input);
    void choose_outputs(const std::string& path);

    cv::dnn::Net net_;
    bool channels_last_ = false;
    std::size_t joints_ = 0, presence_ = 0;  ///< which outputs
};

}  // namespace gesture
