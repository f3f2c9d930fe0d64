// A detected object, as every detector returns it.
#pragma once

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace detect {

struct Keypoint {
    cv::Point at;      ///< px of the image, perhaps outside
    double score = 1;  ///< 0 to 1; 1 as well where the network gives none
};

struct Object {
    cv::Rect box;      ///< px, within the image
    std::string name;  ///< of its class
    double score = 0;  ///< of a network 0 to 1; of the people finder the margin of its classifier, mostly 0 to 4
    std::vector<cv::Point> corners = {};   ///< px; four, of an oriented box
    std::vector<cv::Point> mask = {};      ///< px; its outline
    std::vector<Keypoint> keypoints = {};  ///< in the order of the network
};

constexpr std::size_t max_objects = 300;  ///< of one image; the best

/// The best first; of equal ones from top to bottom, then from left to right.
void sort(std::vector<Object>& objects);
/// Frames and names the objects in a BGR image.
void draw(cv::Mat& image, const std::vector<Object>& objects);

}  // namespace detect
