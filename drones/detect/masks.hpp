// Computes the outline of an object from the mask of a segmenting network.
#pragma once

#include <opencv2/core/mat.hpp>

#include <vector>

namespace detect {

/// The outline of the largest part of the mask, at most 64 points in px of the input; empty: no mask in the box.
/// @param prototypes    1 x M x H x W: images of the whole input
/// @param coefficients  M; the mask is where the prototypes' sum with these weights is above 0 (YOLACT, Bolya et al.)
/// @param box           in px of the input
std::vector<cv::Point> mask_outline(const cv::Mat& prototypes, const std::vector<float>& coefficients,
                                    const cv::Rect2d& box, cv::Size input);

}  // namespace detect
