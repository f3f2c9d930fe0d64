// Composes the scene: background, walkers, faces on their paths, noise.
#include "scene.hpp"

#include "drawn_face.hpp"
#include "hand_path.hpp"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace camera {
namespace {

/// Each image uses the noise field from another offset, so noise is as good as new and costs two additions.
constexpr std::uint64_t noise_offsets = 1 << 16;

/// A well mixed number of a number (the finalizer of SplitMix64).
std::uint64_t mixed(std::uint64_t value)
{
    value += 0x9E3779B97F4A7C15;
    value = (value ^ value >> 30) * 0xBF58476D1CE4E5B9;
    value = (value ^ value >> 27) * 0x94D049BB133111EB;
    return value ^ value >> 31;
}

/// Swings between 0 and 1 once in `period` images.
double swing(std::int64_t index, int period, std::uint64_t seed)
{
    const double start = static_cast<double>(mixed(seed) % 1000) / 1000;
    return 0.5 + 0.5 * std::sin(2 * std::numbers::pi * (static_cast<double>(index % period) / period + start));
}

const SceneSettings& checked(const SceneSettings& settings)
{
    if (settings.size.width < 64 || settings.size.height < 64)
        throw std::invalid_argument("the scene needs at least 64x64 pixels");
    if (settings.faces < 0 || settings.faces > 3)
        throw std::invalid_argument("the scene has 0 to 3 faces");
    if (settings.walkers < 0 || settings.walkers > Walkers::most)
        throw std::invalid_argument("the scene has 0 to 4 walkers");
    return settings;
}

}  // namespace

Scene::Scene(const SceneSettings& settings)
    : settings_(checked(settings)),
      walkers_(settings.walkers, settings.size, settings.seed),
      background_(draw_background(settings.background, settings.size, settings.seed))
{
    cv::RNG random(settings.seed + 2);
    const int bytes = settings.size.area() * 3 + static_cast<int>(noise_offsets);
    cv::Mat noise(1, bytes, CV_16SC1);
    random.fill(noise, cv::RNG::NORMAL, 0, settings.noise);
    noise.convertTo(brighter_, CV_8U);
    noise.convertTo(darker_, CV_8U, -1);
}

SceneFrame Scene::frame(std::int64_t index, cv::MatAllocator* memory) const
{
    SceneFrame result;
    result.image.allocator = memory;
    background_.copyTo(result.image);
    add_walkers(result, index);
    add_faces(result, index);
    if (const auto hand = settings_.hand ? hand_at(index, settings_.size) : std::nullopt) {
        draw_hand(result.image, *hand);
        result.hands.push_back(*hand);
    }
    add_noise(result.image, index);
    return result;
}

void Scene::add_walkers(SceneFrame& frame, std::int64_t index) const
{
    for (const auto& [id, walker] : walkers_.at(index)) {
        draw_walker(frame.image, walker);
        if (const auto box = visible_box(walker, settings_.size))
            frame.truth.push_back({"walker", id, *box});
    }
}

void Scene::add_faces(SceneFrame& frame, std::int64_t index) const
{
    for (int face = 0; face < settings_.faces; ++face) {
        frame.truth.push_back({"face", face + 1, face_box(face, index)});
        draw_face(frame.image, frame.truth.back().box);
    }
}

/// A Lissajous path inside the face's own upright strip of the image, so that faces never meet. Above the box there
/// is a quarter of its height for the hair, below a tenth for the chin.
cv::Rect2d Scene::face_box(int face, std::int64_t index) const
{
    const std::uint64_t seed = settings_.seed * 97 + static_cast<std::uint64_t>(face) * 7;
    const double strip = static_cast<double>(settings_.size.width) / settings_.faces, height = settings_.size.height;
    const double largest = std::min(0.375 * height, 0.9 * strip);
    const double side = largest * (0.5 + 0.5 * swing(index, 211 + 12 * face, seed));
    const double x = face * strip + (strip - side) * swing(index, 131 + 22 * face, seed + 1);
    const double y = 0.25 * side + (height - 1.35 * side) * swing(index, 97 + 16 * face, seed + 2);
    return {x, y, side, side};
}

void Scene::add_noise(cv::Mat& image, std::int64_t index) const
{
    if (settings_.noise <= 0)
        return;
    const auto offset =
        static_cast<int>(mixed(settings_.seed ^ static_cast<std::uint64_t>(index) << 8) % noise_offsets);
    const cv::Range part(offset, offset + static_cast<int>(image.total()) * 3);
    cv::Mat flat = image.reshape(1, 1);
    cv::add(flat, brighter_.colRange(part), flat);
    cv::subtract(flat, darker_.colRange(part), flat);
}

}  // namespace camera
