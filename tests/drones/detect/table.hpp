// A network's output, written as numbers.
#pragma once

#include <opencv2/core/mat.hpp>

#include <vector>

inline cv::Mat table(const std::vector<int>& shape, std::vector<float> numbers)
{
    return cv::Mat(static_cast<int>(shape.size()), shape.data(), CV_32F, numbers.data()).clone();
}
