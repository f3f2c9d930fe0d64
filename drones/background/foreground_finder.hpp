// Finds the foreground: the algorithm of the background drone, plain OpenCV.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/video/background_segm.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace background {

/// Settings of the background model; a change starts a new one.
struct ModelSettings {
    std::string method = "mog2";  ///< mog2: a mixture of gaussians for each pixel; knn: its nearest earlier values
    int history = 500;            ///< images that the model remembers, at least 1
    double threshold = 0;  ///< squared distance from the background: in variances (mog2), in grey levels (knn); 0: 16
                           ///< (mog2), 400 (knn)
    bool shadows = false;  ///< distinguish shadows from things

    bool operator==(const ModelSettings&) const = default;
};

/// A connected part of the foreground.
struct Blob {
    cv::Rect box;
    int area = 0;  ///< of its foreground, px

    bool operator==(const Blob&) const = default;
};

/// One image's foreground.
struct Foreground {
    cv::Mat mask;                ///< grey: 255 foreground, 0 background, 127 shadow
    std::vector<Blob> blobs;     ///< at most max_blobs, the largest; from top to bottom, then from left to right
    std::int64_t learned = 0;    ///< images that the model has seen, this one included
    bool light_changed = false;  ///< at this image: the model was restarted with the known background in the new light
};

class ForegroundFinder {
public:
    static constexpr std::size_t max_blobs = 256;
    static constexpr int young = 4;  ///< the first images of a model are all background
    static constexpr unsigned char foreground = 255, shadow = 127;

    ModelSettings model;
    int open = 1;        ///< specks thinner than about twice this are erased, px; 0: none
    int close = 5;       ///< gaps narrower than about twice this are filled, px; 0: none
    int min_area = 300;  ///< of a blob, px
    double light = 50;   ///< foreground, % of the image, above which to check for a change of the light; 100: never

    /// Processes the next image. The first one, and one of another size or number of channels, starts a new model; so
    /// does one that is mostly the known background in another light.
    /// @param image  8 bit, BGR or grey; not changed
    [[nodiscard]] Foreground find(const cv::Mat& image);
    /// Makes the next image start a new model.
    void restart() { subtractor_.release(); }

private:
    void begin(const cv::Mat& image);
    [[nodiscard]] bool relight(const cv::Mat& image, const cv::Mat& mask);
    void tidy(cv::Mat& mask) const;
    [[nodiscard]] std::vector<Blob> blobs_of(const cv::Mat& mask) const;

    cv::Ptr<cv::BackgroundSubtractor> subtractor_;
    ModelSettings started_with_;
    cv::Size size_;
    int type_ = 0;
    std::int64_t learned_ = 0, known_at_ = 0;
    cv::Mat known_;  ///< small copy of the background after known_at_ images; empty: none yet
};

}  // namespace background
