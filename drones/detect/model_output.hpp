// Converts the outputs of a detector network to candidates.
#pragma once

#include "layouts.hpp"

#include <vector>

namespace detect {

/// A detected candidate, in px of the network's input.
struct Candidate {
    cv::Rect2d box = {};            ///< upright, before it is turned by `angle`
    int class_index = 0;            ///< from 0; as the model counts: of SSD 0 is the background
    double score = 0;               ///< of the best class
    double angle = 0;               ///< about the middle of the box, clockwise, in radians
    std::vector<float> extra = {};  ///< coefficients of the mask, or the numbers of the keypoints
};

/// The candidates in the outputs whose score is at least `min_score`; of a classifier all classes that have it.
/// @param input  size of the network's input
/// @throws std::runtime_error  for a score above 1: the model does not have this layout
std::vector<Candidate> candidates(const std::vector<cv::Mat>& outputs, const Place& place, cv::Size input,
                                  double min_score);

}  // namespace detect
