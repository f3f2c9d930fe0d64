// Draws the walls of the synthetic scene. Sizes in pixels and intensities are chosen so that detectors find nothing in
// them.
#include "background.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <array>

namespace camera {
namespace {

/// Bricks of 64x24 px in rows shifted by half a brick, with joints of 2 px, each brick a little lighter or darker.
cv::Mat bricks(cv::Size size, cv::RNG& random)
{
    constexpr int brick_width = 64, brick_height = 24, joint = 2;
    cv::Mat wall(size, CV_8UC3, cv::Scalar::all(120));
    for (int row = 0; row * brick_height < size.height; ++row)
        for (int x = row % 2 == 0 ? 0 : -brick_width / 2; x < size.width; x += brick_width) {
            const cv::Scalar colour = cv::Scalar(78, 92, 128) + cv::Scalar::all(random.uniform(-18.0, 18.0));
            const cv::Rect brick(x, row * brick_height, brick_width - joint, brick_height - joint);
            wall(brick & cv::Rect({}, size)).setTo(colour);
        }
    cv::Mat grain(size, CV_16SC1), grains;
    random.fill(grain, cv::RNG::NORMAL, 0, 5);
    cv::merge(std::array{grain, grain, grain}, grains);
    cv::add(wall, grains, wall, cv::noArray(), CV_8U);
    return wall;
}

/// Four octaves of smoothly enlarged random cells, per channel.
cv::Mat soft_noise(cv::Size size, cv::RNG& random)
{
    struct Octave {
        int cell, amplitude;
    };
    cv::Mat sum(size, CV_32FC3, cv::Scalar::all(96));
    for (const Octave octave : {Octave{160, 24}, {64, 14}, {24, 8}, {8, 4}}) {
        cv::Mat cells(size.height / octave.cell + 2, size.width / octave.cell + 2, CV_32FC3), enlarged;
        random.fill(cells, cv::RNG::UNIFORM, -octave.amplitude, octave.amplitude);
        cv::resize(cells, enlarged, {}, octave.cell, octave.cell, cv::INTER_CUBIC);
        sum += enlarged(cv::Rect({}, size));
    }
    cv::Mat image;
    sum.convertTo(image, CV_8U);
    return image;
}

}  // namespace

cv::Mat draw_background(Background background, cv::Size size, std::uint64_t seed)
{
    cv::RNG random(seed + 1);
    switch (background) {
    case Background::brick: return bricks(size, random);
    case Background::noise: return soft_noise(size, random);
    case Background::plain: break;
    }
    return {size, CV_8UC3, cv::Scalar::all(130)};
}

}  // namespace camera
