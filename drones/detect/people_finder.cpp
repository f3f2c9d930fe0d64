// Calls OpenCV's detector and tightens its boxes.
#include "people_finder.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace detect {
namespace {

/// Where in the window a person is, measured on drawn and filmed walkers.
cv::Rect without_margin(const cv::Rect& box)
{
    const auto part = [](int length, double share) { return static_cast<int>(std::lround(length * share)); };
    return {box.x + part(box.width, 0.1), box.y + part(box.height, 0.07), part(box.width, 0.8), part(box.height, 0.85)};
}

}  // namespace

PeopleFinder::PeopleFinder() { descriptor_.setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector()); }

std::vector<Object> PeopleFinder::find(const cv::Mat& image) const
{
    cv::Mat looked_at = image;
    if (enlarge > 1)
        cv::resize(image, looked_at, {}, enlarge, enlarge, cv::INTER_LINEAR);
    const cv::Size padded = looked_at.size() + cv::Size(2 * padding, 2 * padding), window = descriptor_.winSize;
    if (padded.width < window.width || padded.height < window.height)
        return {};
    std::vector<cv::Rect> boxes;
    std::vector<double> weights;
    descriptor_.detectMultiScale(looked_at, boxes, weights, hit_threshold, {stride, stride}, {padding, padding}, scale,
                                 grouping);
    std::vector<Object> people;
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (const cv::Rect box = in_image(boxes[i]) & cv::Rect({}, image.size()); !box.empty())
            people.push_back({box, "person", weights[i]});
    sort(people);
    people.resize(std::min(people.size(), max_objects));
    return people;
}

cv::Rect PeopleFinder::in_image(const cv::Rect& window) const
{
    const cv::Rect box = shrink ? without_margin(window) : window;
    const auto back = [&](int length) { return static_cast<int>(std::lround(length / std::max(1.0, enlarge))); };
    return {back(box.x), back(box.y), back(box.width), back(box.height)};
}

}  // namespace detect
