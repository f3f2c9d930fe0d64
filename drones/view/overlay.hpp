// Writes text on images, and draws the notice that is shown without one. Plain OpenCV.
#pragma once

#include <opencv2/core/mat.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace view {

/// The origin and rate of an image.
struct Origin {
    std::string sender = {};    ///< drone and output: "face.annotated"
    std::string source = {};    ///< the drone that captured it
    std::int64_t sequence = 0;  ///< of the capture
    cv::Size size = {};         ///< px
    std::optional<std::chrono::system_clock::time_point> captured = {};
    double rate = 0;  ///< frames per second at its arrival; 0: not known yet
};

/// "face.annotated from camera  29.8 fps  12 ms"; unknown parts are omitted.
std::string caption(const Origin& origin, std::chrono::system_clock::time_point now);
/// "12 ms", "3.4 s", "7 min"
std::string age_text(std::chrono::milliseconds age);

/// A copy of `image` (8 bit, grey or BGR) with the text on a dark strip at its lower edge, small enough for its
/// width.
cv::Mat with_caption(const cv::Mat& image, const std::string& text);
/// A dark image with a text in the middle.
cv::Mat notice(const std::string& text, cv::Size size = {640, 360});

}  // namespace view
