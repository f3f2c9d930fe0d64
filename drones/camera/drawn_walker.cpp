// The geometry and colours of the drawn walker, in heights: x from its middle, y from its top.
#include "drawn_walker.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace camera {
namespace {

/// Draws in the walker's own coordinates.
class Pen {
public:
    Pen(cv::Mat& image, const Walker& walker) : image_(image), walker_(walker) {}

    void line(cv::Point2d from, cv::Point2d to, double thickness, const cv::Scalar& colour)
    {
        const int px = std::max(1, static_cast<int>(std::lround(thickness * walker_.height)));
        cv::line(image_, place(from), place(to), colour, px, cv::LINE_AA, parts_bits);
    }
    void ellipse(cv::Point2d middle, cv::Size2d radii, const cv::Scalar& colour) { arc(middle, radii, 0, 360, colour); }
    /// Filled, from one angle to the other: 0 right, 90 down, 270 up.
    void arc(cv::Point2d middle, cv::Size2d radii, double from, double to, const cv::Scalar& colour)
    {
        const cv::Size size(std::lround(radii.width * walker_.height * parts),
                            std::lround(radii.height * walker_.height * parts));
        cv::ellipse(image_, place(middle), size, 0, from, to, colour, cv::FILLED, cv::LINE_AA, parts_bits);
    }

private:
    static constexpr int parts_bits = 4, parts = 1 << parts_bits;  // OpenCV draws at sixteenths of a pixel

    [[nodiscard]] cv::Point place(cv::Point2d at) const
    {
        return {static_cast<int>(std::lround((walker_.middle + at.x * walker_.height) * parts)),
                static_cast<int>(std::lround((walker_.top + at.y * walker_.height) * parts))};
    }

    cv::Mat& image_;
    const Walker& walker_;
};

/// One side's leg and shoe. @param step  how far the foot is before the hip
void draw_leg(Pen& pen, double side, double step, const cv::Scalar& colour)
{
    const cv::Point2d hip(0.035 * side, 0.50), knee(side * (0.04 + step / 2), 0.74), foot(side * (0.045 + step), 0.97);
    pen.line(hip, knee, 0.075, colour);
    pen.line(knee, foot, 0.06, colour);
    pen.line(foot, foot + cv::Point2d(0.03, 0), 0.04, {25, 25, 25});
}

void draw_arm(Pen& pen, double side, double step)
{
    const cv::Scalar sleeve(70, 60, 60);
    const cv::Point2d shoulder(0.10 * side, 0.21), elbow(side * (0.115 - step / 2), 0.36),
        hand(side * (0.11 - step), 0.50);
    pen.line(shoulder, elbow, 0.05, sleeve);
    pen.line(elbow, hand, 0.042, sleeve);
}

void draw_torso_and_head(Pen& pen)
{
    const cv::Scalar coat(75, 62, 60), skin(125, 150, 190), neck(110, 130, 165), hair(30, 32, 38);
    pen.ellipse({0, 0.34}, {0.105, 0.19}, coat);
    pen.line({-0.075, 0.205}, {0.075, 0.205}, 0.06, coat);
    pen.line({0, 0.14}, {0, 0.18}, 0.06, neck);
    pen.ellipse({0, 0.08}, {0.058, 0.078}, skin);
    pen.arc({0, 0.055}, {0.06, 0.055}, 180, 360, hair);
}

}  // namespace

void draw_walker(cv::Mat& image, const Walker& walker)
{
    const double step = 0.10 * std::sin(walker.phase);
    Pen pen(image, walker);
    draw_leg(pen, -1, step, {45, 40, 38});
    draw_leg(pen, 1, step, {52, 46, 42});
    draw_arm(pen, -1, step);
    draw_arm(pen, 1, step);
    draw_torso_and_head(pen);
}

}  // namespace camera
