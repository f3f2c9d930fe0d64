// The geometry and intensities of the drawn face, in the unit square of its box: u to the right, v down.
#include "drawn_face.hpp"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace camera {
namespace {

float smooth_step(float t)
{
    t = std::clamp(t, 0.0F, 1.0F);
    return t * t * (3 - 2 * t);
}

/// An ellipse with a soft rim: 1 inside, falling to 0 between 1-soft and 1+soft radii.
struct Ellipse {
    float u, v, radius_u, radius_v, soft;

    [[nodiscard]] float at(float at_u, float at_v) const
    {
        const float du = (at_u - u) * (1 / radius_u), dv = (at_v - v) * (1 / radius_v), squared = du * du + dv * dv;
        if (squared >= (1 + soft) * (1 + soft))
            return 0;
        if (squared <= (1 - soft) * (1 - soft))
            return 1;
        return 1 - smooth_step((std::sqrt(squared) - (1 - soft)) / (2 * soft));
    }
};

/// What an ellipse does to the luminance: darkens by a factor, or adds light.
struct Feature {
    Ellipse where;
    float darken, lighten;
};

void add_pair(std::vector<Feature>& features, float distance, Ellipse where, float darken, float lighten)
{
    for (const float side : {-1.0F, 1.0F}) {
        where.u = 0.5F + side * distance;
        features.push_back({where, darken, lighten});
    }
}

std::vector<Feature> make_features()
{
    std::vector<Feature> features;
    add_pair(features, .16F, {0, .29F, .11F, .024F, .5F}, .55F, 0);    // brows
    add_pair(features, .16F, {0, .39F, .13F, .073F, .6F}, .40F, 0);    // sockets
    add_pair(features, .16F, {0, .395F, .064F, .032F, .3F}, .45F, 0);  // eyes
    add_pair(features, .16F, {0, .395F, .027F, .031F, .3F}, .60F, 0);  // pupils
    add_pair(features, .19F, {0, .575F, .10F, .077F, .9F}, 0, .07F);   // cheeks
    features.push_back({{.5F, .445F, .038F, .17F, .7F}, 0, .10F});     // ridge of the nose
    add_pair(features, .043F, {0, .62F, .024F, .015F, .5F}, .45F, 0);  // nostrils
    features.push_back({{.5F, .637F, .077F, .021F, .8F}, .15F, 0});    // shadow under the nose
    features.push_back({{.5F, .757F, .145F, .026F, .4F}, .45F, 0});    // mouth
    features.push_back({{.5F, .808F, .094F, .017F, .9F}, .15F, 0});    // crease under the mouth
    return features;
}

constexpr Ellipse head{.5F, .505F, .37F, .53F, .04F};
constexpr Ellipse hair_shape{.5F, .42F, .43F, .56F, .04F};
constexpr float top = -0.15F, bottom = 1.06F;  // what the head and the hair reach

float hair_at(float u, float v)
{
    const float hairline = v - 0.85F * (u - 0.5F) * (u - 0.5F);
    return hairline >= .13F ? 0 : hair_shape.at(u, v) * (1 - smooth_step((hairline - .08F) / (.13F - .08F)));
}

float luminance_at(const std::vector<const Feature*>& features, float u, float v)
{
    const float from_middle = (u - 0.5F) / 0.37F;
    float luminance = 0.80F - 0.25F * from_middle * from_middle + 0.03F * (0.3F - v);
    for (const Feature* feature : features)
        if (const float strength = feature->where.at(u, v); strength > 0)
            luminance = luminance * (1 - feature->darken * strength) + feature->lighten * strength;
    return luminance;
}

/// Mixes the face into one pixel of the background.
void mix(cv::Vec3b& pixel, float alpha, float hair, float luminance)
{
    constexpr std::array skin{.72F, .84F, 1.00F}, dark{.10F, .13F, .17F};
    for (int channel = 0; channel < 3; ++channel) {
        const float tone = luminance * skin[channel] * (1 - hair) + dark[channel] * hair;
        const float mixed = static_cast<float>(pixel[channel]) * (1 - alpha) + 255 * tone * alpha;
        pixel[channel] =
            static_cast<unsigned char>(mixed + 0.5F);  // all parts are within 0 to 1, so the sum is within 0 to 255
    }
}

/// The features that touch the row `v`: most rows see few of them.
std::vector<const Feature*> features_of_row(float v)
{
    static const std::vector<Feature> all = make_features();
    std::vector<const Feature*> here;
    for (const Feature& feature : all)
        if (std::abs(v - feature.where.v) < feature.where.radius_v * (1 + feature.where.soft))
            here.push_back(&feature);
    return here;
}

}  // namespace

void draw_face(cv::Mat& image, const cv::Rect2d& box)
{
    const int first_row = std::max(0, static_cast<int>(box.y + top * box.height));
    const int end_row = std::min(image.rows, static_cast<int>(box.y + bottom * box.height) + 1);
    const int first_column = std::max(0, static_cast<int>(box.x));
    const int end_column = std::min(image.cols, static_cast<int>(box.x + box.width) + 1);
    for (int y = first_row; y < end_row; ++y) {
        const auto v = static_cast<float>((y + 0.5 - box.y) / box.height);
        const auto features = features_of_row(v);
        auto* row = image.ptr<cv::Vec3b>(y);
        for (int x = first_column; x < end_column; ++x) {
            const auto u = static_cast<float>((x + 0.5 - box.x) / box.width);
            const float hair = hair_at(u, v), alpha = std::max(head.at(u, v), hair);
            if (alpha > 0)
                mix(row[x], alpha, hair, luminance_at(features, u, v));
        }
    }
}

}  // namespace camera
