// Compares found boxes with true ones.
#pragma once

#include <opencv2/core/types.hpp>

#include <vector>

namespace overlap {

inline double intersection_over_union(const cv::Rect2d& a, const cv::Rect2d& b)
{
    const double both = (a & b).area();
    return both / (a.area() + b.area() - both);
}

/// Counts true boxes that were found, and found boxes that are not true.
struct Score {
    int hits = 0, misses = 0, false_alarms = 0;

    void add(const std::vector<cv::Rect>& found, const std::vector<cv::Rect2d>& truth, double enough)
    {
        std::vector<bool> used(found.size());
        for (const cv::Rect2d& box : truth) {
            std::size_t i = 0;
            while (i < found.size() && (used[i] || intersection_over_union(found[i], box) < enough))
                ++i;
            if (i < found.size())
                used[i] = true;
            ++(i < found.size() ? hits : misses);
        }
        for (const bool was_used : used)
            false_alarms += !was_used;
    }
};

}  // namespace overlap
