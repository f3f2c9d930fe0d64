// Sorts objects and draws them into an image.
#include "object.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdio>
#include <tuple>

namespace detect {

void sort(std::vector<Object>& objects)
{
    std::ranges::stable_sort(
        objects, {}, [](const Object& object) { return std::tuple(-object.score, object.box.y, object.box.x); });
}

void draw(cv::Mat& image, const std::vector<Object>& objects)
{
    const cv::Scalar green(60, 220, 60);
    for (const Object& object : objects) {
        char score[32];
        std::snprintf(score, sizeof score, " %.2f", object.score);
        if (object.corners.empty())
            cv::rectangle(image, object.box, green, 2, cv::LINE_AA);
        for (const auto* outline : {&object.corners, &object.mask})
            cv::polylines(image, *outline, true, green, 2, cv::LINE_AA);
        for (const Keypoint& keypoint : object.keypoints)
            if (keypoint.score >= 0.5)
                cv::circle(image, keypoint.at, 3, green, cv::FILLED, cv::LINE_AA);
        cv::putText(image, object.name + score, object.box.tl() + cv::Point(4, 16), cv::FONT_HERSHEY_SIMPLEX, 0.5,
                    green, 1, cv::LINE_AA);
    }
}

}  // namespace detect
