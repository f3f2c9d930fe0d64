// The paths are in parts of the image's size, so that every size shows the same scene.
#include "walkers.hpp"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace camera {
namespace {

/// Heights and the ground under the feet in parts of the image's height; speed in parts of its width per image.
struct Lane {
    double height, ground, speed;
    std::int64_t first;
};
constexpr std::array<Lane, Walkers::most> lanes{
    {{0.30, 0.66, 0.0050, 30}, {0.36, 0.78, -0.0062, 40}, {0.32, 0.71, -0.0041, 75}, {0.42, 0.93, 0.0078, 110}}};

/// A person comes and goes this far outside, in parts of the image's height.
constexpr double outside = 0.12;
/// Frames between the exit of one person and the entry of the next.
constexpr std::int64_t pause = 15;
/// The length of a whole step (two feet), in heights of the walker: four times the largest step of a foot.
constexpr double stride = 0.4;

}  // namespace

std::vector<Passer> Walkers::at(std::int64_t index) const
{
    std::vector<Passer> passers;
    for (int lane = 0; lane < lanes_; ++lane)
        if (const auto passer = on_lane(lane, index))
            passers.push_back(*passer);
    std::ranges::sort(passers, {}, [](const Passer& passer) { return passer.walker.top + passer.walker.height; });
    return passers;
}

std::optional<Passer> Walkers::on_lane(int number, std::int64_t index) const
{
    const Lane& lane = lanes[static_cast<std::size_t>(number)];
    const double margin = outside * size_.height, way = size_.width + 2 * margin,
                 speed = std::abs(lane.speed) * size_.width;
    const auto crossing = static_cast<std::int64_t>(std::ceil(way / speed)) + pause;
    if (index < lane.first)
        return std::nullopt;
    const std::int64_t turn = (index - lane.first) / crossing;
    const double walked = speed * static_cast<double>((index - lane.first) % crossing);
    if (walked > way)
        return std::nullopt;
    cv::RNG random((seed_ * 31 + static_cast<std::uint64_t>(number)) * 4099 + static_cast<std::uint64_t>(turn));
    static_cast<void>(random.next());  // the first number follows the seed closely
    const double height = size_.height * lane.height * random.uniform(0.9, 1.1);
    const double x = lane.speed > 0 ? walked - margin : size_.width + margin - walked;
    const double phase = 2 * std::numbers::pi * walked / (stride * height);
    return Passer{static_cast<int>(turn) * most + number + 1, {x, lane.ground * size_.height - height, height, phase}};
}

std::optional<cv::Rect2d> visible_box(const Walker& walker, cv::Size size)
{
    const cv::Rect2d box = walker.box(), part = box & cv::Rect2d({}, cv::Size2d(size));
    return part.area() >= 0.5 * box.area() ? std::optional(part) : std::nullopt;
}

}  // namespace camera
