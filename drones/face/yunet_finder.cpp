// Checks that the model has the outputs that OpenCV's detector assumes, and converts its table to faces.
#include "yunet_finder.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace face {
namespace {

/// The number of values per face in each of the model's three outputs.
constexpr std::array<std::pair<const char*, std::size_t>, 3> outputs{{{"loc", 14}, {"conf", 2}, {"iou", 1}}};
constexpr int boxes_before_suppression = 5000;

/// How many places of an image YuNet looks at: three, two, two and three in each cell of four coarser and coarser
/// grids.
std::size_t places_in(cv::Size size)
{
    cv::Size grid((size.width + 1) / 2 / 2, (size.height + 1) / 2 / 2);
    std::size_t places = 0;
    for (const std::size_t each : {3U, 2U, 2U, 3U}) {
        grid = {grid.width / 2, grid.height / 2};
        places += each * static_cast<std::size_t>(grid.area());
    }
    return places;
}

cv::Mat colour(const cv::Mat& image)
{
    if (image.channels() == 3)
        return image;
    cv::Mat result;
    cv::cvtColor(image, result, cv::COLOR_GRAY2BGR);
    return result;
}

}  // namespace

YunetFinder::YunetFinder(const std::string& path) : path_(path)
{
    if (!std::filesystem::is_regular_file(path))
        throw std::runtime_error("no model at " + path);
    try {
        net_ = cv::dnn::readNetFromONNX(path);
        detector_ = cv::FaceDetectorYN::create(path, "", {320, 320});
    } catch (const cv::Exception&) {  // names lines of OpenCV; the error below is for users
        throw std::runtime_error(path + " is not an ONNX model that OpenCV's DNN can read");
    }
}

/// OpenCV's detector reads the expected number of values without checking the size.
void YunetFinder::prepare(cv::Size size)
{
    if (size == size_)
        return;
    std::vector<cv::Mat> found;
    try {
        net_.setInput(cv::dnn::blobFromImage(cv::Mat(size, CV_8UC3, cv::Scalar::all(0))));
        net_.forward(found, std::vector<cv::String>{outputs[0].first, outputs[1].first, outputs[2].first});
    } catch (const cv::Exception& error) {
        throw std::runtime_error(path_ + " is not a YuNet for OpenCV 4.6 (outputs loc, conf and iou), or does not take "
                                 + std::to_string(size.width) + "x" + std::to_string(size.height)
                                 + " px: " + error.err);
    }
    for (std::size_t i = 0; i < outputs.size(); ++i)
        if (found[i].type() != CV_32F || found[i].total() != outputs[i].second * places_in(size))
            throw std::runtime_error(path_ + " is not a YuNet: for " + std::to_string(size.width) + "x"
                                     + std::to_string(size.height) + " px its output " + outputs[i].first + " has "
                                     + std::to_string(found[i].total()) + " numbers instead of "
                                     + std::to_string(outputs[i].second * places_in(size)));
    detector_->setInputSize(size);
    size_ = size;
}

std::vector<Face> YunetFinder::find(const cv::Mat& image)
{
    prepare(image.size());
    detector_->setScoreThreshold(static_cast<float>(min_score));
    detector_->setNMSThreshold(static_cast<float>(overlap));
    detector_->setTopK(boxes_before_suppression);
    cv::Mat table;
    detector_->detect(colour(image), table);
    std::vector<Face> faces;
    for (int row = 0; row < table.rows; ++row) {
        const float* numbers = table.ptr<float>(row);
        if (!std::all_of(numbers, numbers + 15, [](float number) { return std::abs(number) < 1e6F; }))
            continue;
        Face face{cv::Rect(cv::Rect2f(numbers[0], numbers[1], numbers[2], numbers[3])) & cv::Rect({}, image.size()),
                  numbers[14]};
        for (std::size_t i = 0; i < face.points.size(); ++i)
            face.points[i] = {numbers[4 + 2 * i], numbers[5 + 2 * i]};
        if (!face.box.empty())
            faces.push_back(face);
    }
    std::ranges::stable_sort(faces, std::ranges::greater{}, &Face::score);
    faces.resize(std::min(faces.size(), max_faces));
    std::ranges::stable_sort(faces, {}, [](const Face& face) {
        return std::tuple(face.box.y, face.box.x, face.box.height, face.box.width);
    });
    return faces;
}

}  // namespace face
