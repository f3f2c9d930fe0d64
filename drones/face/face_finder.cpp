// Converts the image to grey, applies the cascade, and sorts the boxes.
#include "face_finder.hpp"

#include <cascade.hpp>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <tuple>

namespace face {

void FaceFinder::load(const std::string& cascade_path) { cascade_ = cascade::load(cascade_path); }

std::vector<cv::Rect> FaceFinder::find(const cv::Mat& image)
{
    cv::Mat grey = image;
    if (image.channels() == 3)
        cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    if (equalise) {
        cv::Mat spread;
        cv::equalizeHist(grey, spread);
        grey = spread;
    }
    const cv::Size most = max_size > 0 ? cv::Size(max_size, max_size) : cv::Size();
    std::vector<cv::Rect> faces;
    cascade_.detectMultiScale(grey, faces, scale, min_neighbors, 0, cv::Size(min_size, min_size), most);
    std::ranges::sort(faces, {}, [](const cv::Rect& box) { return std::tuple(box.y, box.x, box.height, box.width); });
    return faces;
}

void FaceFinder::draw(cv::Mat& image, const std::vector<cv::Rect>& faces)
{
    for (const cv::Rect& box : faces)
        cv::rectangle(image, box, cv::Scalar(60, 220, 60), 2, cv::LINE_AA);
}

}  // namespace face
