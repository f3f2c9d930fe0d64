// Applies thresholds to grey levels or to colours.
#include "silhouette.hpp"

#include <opencv2/imgproc.hpp>

namespace gesture {
namespace {

cv::Mat skin_in(const cv::Mat& image, const SkinRange& range)
{
    if (image.channels() != 3)
        return cv::Mat::zeros(image.size(), CV_8UC1);
    cv::Mat colours, result;
    cv::cvtColor(image, colours, cv::COLOR_BGR2YCrCb);
    cv::inRange(colours, cv::Scalar(range.y_min, range.cr_min, range.cb_min),
                cv::Scalar(range.y_max, range.cr_max, range.cb_max), result);
    return result;
}

}  // namespace

cv::Mat Silhouette::of(const cv::Mat& image) const
{
    if (from == "skin")
        return skin_in(image, skin);
    cv::Mat grey = image, result;
    if (image.channels() == 3)
        cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    cv::threshold(grey, result, level - 1, 255, cv::THRESH_BINARY);
    return result;
}

}  // namespace gesture
