// The synthetic scene: moving drawn things in front of a wall, with sensor noise and ground truth.
#pragma once

#include "background.hpp"
#include "drawn_hand.hpp"
#include "walkers.hpp"

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace camera {

struct SceneSettings {
    cv::Size size{640, 480};  ///< at least 64x64
    Background background = Background::brick;
    int faces = 1;      ///< 0 to 3
    int walkers = 0;    ///< 0 to 4
    bool hand = false;  ///< one hand that shows changing numbers of fingers, see hand_path.hpp
    double noise = 3;   ///< standard deviation of the gaussian sensor noise, grey levels
    std::uint64_t seed = 1;

    bool operator==(const SceneSettings&) const = default;
};

/// A drawn thing and its box.
struct Truth {
    std::string kind;  ///< "face", "walker"
    int id;            ///< of this thing among its kind, the same in all images
    cv::Rect2d box;    ///< px, inside the image
    bool operator==(const Truth&) const = default;
};

/// One frame of the scene, with its ground truth.
struct SceneFrame {
    cv::Mat image;  ///< BGR
    std::vector<Truth>
        truth;  ///< faces are wholly inside; a walker is here while half of it is, with that part of its box
    std::vector<DrawnHand> hands;  ///< none in the images without the hand
};

/// Static parts are drawn once; an image depends only on the settings and its index.
class Scene {
public:
    explicit Scene(const SceneSettings& settings);

    /// @param memory  allocator of the pixels; null: OpenCV's own
    [[nodiscard]] SceneFrame frame(std::int64_t index, cv::MatAllocator* memory = nullptr) const;

private:
    void add_walkers(SceneFrame& frame, std::int64_t index) const;
    void add_faces(SceneFrame& frame, std::int64_t index) const;
    [[nodiscard]] cv::Rect2d face_box(int face, std::int64_t index) const;
    void add_noise(cv::Mat& image, std::int64_t index) const;

    SceneSettings settings_;
    Walkers walkers_;
    cv::Mat background_;
    cv::Mat brighter_, darker_;  ///< the noise, one row of bytes each: what it adds and what it takes away
};

}  // namespace camera
