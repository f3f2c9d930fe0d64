// The geometry of the drawn hand, in radii of its palm, and its shading.
#include "drawn_hand.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace camera {
namespace {

/// Where the fingers but the thumb point, degrees: 0 is to the right, clockwise.
std::vector<double> directions(int fingers)
{
    switch (fingers) {
    case 0: return {};
    case 1: return {-90};
    case 2: return {-105, -78};
    case 3: return {-118, -92, -66};
    default: return {-128, -103, -78, -53};
    }
}
constexpr double thumb = -12;

class Silhouette {
public:
    Silhouette(cv::Size size, const DrawnHand& hand) : mask_(size, CV_8UC1, cv::Scalar(0)), hand_(hand)
    {
        line(90, {0, hand.arm}, 1.1);
        cv::circle(mask_, place(0, 0), static_cast<int>(std::lround(16 * hand.radius)), 255, cv::FILLED, cv::LINE_8, 4);
        for (const double direction : directions(hand.fingers))
            line(direction, {0.75, 2.35}, 0.4);
        if (hand.fingers == 5)
            line(thumb, {0.75, 1.75}, 0.4);
    }
    [[nodiscard]] const cv::Mat& mask() const { return mask_; }

private:
    /// In sixteenths of a pixel, as the drawing functions take it.
    [[nodiscard]] cv::Point place(double direction, double distance) const
    {
        const double angle = (direction + hand_.rotation) * std::numbers::pi / 180;
        const cv::Point2d at = hand_.palm + distance * hand_.radius * cv::Point2d(std::cos(angle), std::sin(angle));
        return {static_cast<int>(std::lround(16 * at.x)), static_cast<int>(std::lround(16 * at.y))};
    }

    struct Reach {
        double from, to;
    };
    void line(double direction, Reach reach, double thickness)
    {
        const int pixels = std::max(1, static_cast<int>(std::lround(thickness * hand_.radius)));
        cv::line(mask_, place(direction, reach.from), place(direction, reach.to), 255, pixels, cv::LINE_8, 4);
    }

    cv::Mat mask_;
    DrawnHand hand_;
};

/// Darker towards the edge, as a round thing lit from the front: how bright the skin is, 0.82 to 1.
cv::Mat shading(const cv::Mat& mask, double radius)
{
    cv::Mat light;
    cv::distanceTransform(mask, light, cv::DIST_L2, 5);
    light *= 1 / (0.35 * radius);
    cv::min(light, 1, light);
    return 0.82 + 0.18 * light;
}

}  // namespace

void draw_hand(cv::Mat& image, const DrawnHand& hand)
{
    const cv::Vec3f skin(110, 150, 205);
    const cv::Mat mask = Silhouette(image.size(), hand).mask();
    const cv::Rect around = cv::boundingRect(mask);
    if (around.empty())
        return;
    const cv::Rect part = (around + cv::Size(8, 8) - cv::Point(4, 4)) & cv::Rect({}, image.size());
    cv::Mat alpha;
    mask(part).convertTo(alpha, CV_32F, 1.0 / 255);
    cv::GaussianBlur(alpha, alpha, {}, 1);
    const cv::Mat light = shading(mask(part), hand.radius);
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x) {
            cv::Vec3b& pixel = image.at<cv::Vec3b>(part.y + y, part.x + x);
            const float share = alpha.at<float>(y, x);
            pixel = cv::Vec3f(pixel) * (1 - share) + skin * (light.at<float>(y, x) * share);
        }
}

}  // namespace camera
