// Draws the scene, applies brightness and colour, and encodes JPEG.
#include "painter.hpp"

#include "scene.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <vector>

namespace axis::emulator {
namespace {

cv::Size size_of(const std::string& resolution)
{
    const std::size_t x = resolution.find('x');
    return {std::stoi(resolution.substr(0, x)), std::stoi(resolution.substr(x + 1))};
}

}  // namespace

Painter::Painter() = default;
Painter::~Painter() = default;

std::string Painter::jpeg(const ParameterStore& parameters, const std::string& resolution, int compression,
                          std::int64_t index)
{
    auto& scene = scenes_[resolution];
    if (!scene)
        scene = std::make_unique<camera::Scene>(camera::SceneSettings{.size = size_of(resolution)});
    cv::Mat picture = scene->picture(index).image;
    picture.convertTo(picture, -1, 1, parameters.number("ImageSource.I0.Sensor.Brightness") - 50);
    if (parameters.number("ImageSource.I0.Sensor.ColorLevel") == 0) {
        cv::cvtColor(picture, picture, cv::COLOR_BGR2GRAY);
        cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
    }
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 95 - compression * 9 / 10});
    return {bytes.begin(), bytes.end()};
}

}  // namespace axis::emulator
