// Uses the contour, its hull, its convexity defects and the distance transform. Lengths are in radii of the palm unless
// they say px.
#include "gesture_finder.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gesture {
namespace {

using Contour = std::vector<cv::Point>;

constexpr double near_palm = 1.55;  ///< nearer to the centre is palm
constexpr double finger_length =
    0.20;  ///< a fingertip is at least this much further from the centre than the root of the finger
constexpr double finger_width = 0.85;  ///< a finger is at most so wide, an arm is wider
constexpr double defect_depth = 0.30;  ///< shallower ones are within a finger
constexpr double arm_reach = 2.6;      ///< an arm reaches at least this far from the centre, knuckles do not
constexpr double palm_share = 0.75;    ///< an arm is at most 1 / this as wide as the palm
constexpr double smallest_palm = 6;    ///< px; below it fingers are of one pixel

/// Specks and hairs narrower than `smooth` go, gaps are closed.
cv::Mat cleaned(const cv::Mat& silhouette, int smooth)
{
    if (smooth < 2)
        return silhouette.clone();
    const cv::Mat shape = cv::getStructuringElement(cv::MORPH_ELLIPSE, {smooth, smooth});
    cv::Mat result;
    cv::medianBlur(silhouette, result, smooth | 1);
    cv::morphologyEx(result, result, cv::MORPH_OPEN, shape);
    cv::morphologyEx(result, result, cv::MORPH_CLOSE, shape);
    return result;
}

double length(const cv::Point2d& vector) { return std::hypot(vector.x, vector.y); }

/// Reads one silhouette as a hand.
class Reading {
public:
    Reading(Contour contour, cv::Size image) : contour_(std::move(contour)), image_(image)
    {
        hand_.box = cv::boundingRect(contour_);
        find_palm();
    }

    /// With the palm near a place that is known, not further away than half the radius that it has there.
    Reading(Contour contour, cv::Size image, cv::Point place, double radius)
        : contour_(std::move(contour)), image_(image)
    {
        hand_.box = cv::boundingRect(contour_);
        const cv::Mat depth = depths();
        cv::Mat around = cv::Mat::zeros(depth.size(), CV_8UC1);
        const cv::Point corner = hand_.box.tl() - cv::Point(1, 1);
        cv::circle(around, place - corner, std::max(1, static_cast<int>(radius / 2)), 255, cv::FILLED);
        cv::Point deepest;
        cv::minMaxLoc(depth, nullptr, &hand_.radius, nullptr, &deepest, around);
        hand_.palm = deepest + corner;
    }

    [[nodiscard]] int arms() const { return arms_; }

    [[nodiscard]] double radius() const { return hand_.radius; }

    Hand read()
    {
        const std::vector<bool> cut = cuts();
        const std::size_t count = contour_.size();
        const std::size_t first = static_cast<std::size_t>(std::ranges::find(cut, true) - cut.begin());
        for (std::size_t i = 0; i < count;) {
            std::size_t end = i;
            while (end < count && !cut[(first + end) % count])
                ++end;
            if (end > i)
                take_piece(first + i, first + end);
            i = end + 1;
        }
        finish();
        return std::move(hand_);
    }

private:
    struct Finger {
        cv::Point tip;
        double reach;
    };

    [[nodiscard]] bool at_border(const cv::Point& point) const
    {
        return point.x == 0 || point.y == 0 || point.x == image_.width - 1 || point.y == image_.height - 1;
    }

    [[nodiscard]] double distance(const cv::Point& point) const { return length(point - hand_.palm) / hand_.radius; }

    /// How far inside each pixel is, px. The border of the image is an edge, so that an arm that enters there stays
    /// narrow.
    [[nodiscard]] cv::Mat depths() const
    {
        cv::Mat filled(hand_.box.size() + cv::Size(2, 2), CV_8UC1, cv::Scalar(0)), result;
        cv::drawContours(filled, std::vector<Contour>{contour_}, 0, 255, cv::FILLED, cv::LINE_8, cv::noArray(), 0,
                         cv::Point(1, 1) - hand_.box.tl());
        cv::distanceTransform(filled, result, cv::DIST_L2, 5);
        return result;
    }

    /// Where the arm enters the image, in the coordinates of depths(); nothing if the silhouette is wholly inside.
    [[nodiscard]] std::optional<cv::Point2d> entry() const
    {
        cv::Point2d sum;
        int count = 0;
        for (const cv::Point& point : contour_)
            if (at_border(point)) {
                sum += cv::Point2d(point - hand_.box.tl());
                ++count;
            }
        return count > 0 ? std::optional(sum * (1.0 / count)) : std::nullopt;
    }

    /// The deepest place; but an arm may be as wide as the palm, so of several it is the one away from where the arm
    /// enters.
    void find_palm()
    {
        const cv::Mat depth = depths();
        cv::Point deepest;
        cv::minMaxLoc(depth, nullptr, &hand_.radius, nullptr, &deepest);
        if (const auto arm = entry()) {
            const cv::Mat candidates = depth >= palm_share * hand_.radius;
            cv::Mat around = cv::Mat::zeros(depth.size(), CV_8UC1);
            const cv::Point far = farthest(candidates, *arm);
            cv::circle(around, far, static_cast<int>(depth.at<float>(far)), 255, cv::FILLED);
            cv::minMaxLoc(depth, nullptr, &hand_.radius, nullptr, &deepest, around);
        }
        hand_.palm = deepest + hand_.box.tl() - cv::Point(1, 1);
    }

    static cv::Point farthest(const cv::Mat& candidates, const cv::Point2d& from)
    {
        Contour points;
        cv::findNonZero(candidates, points);
        return *std::ranges::max_element(points, {},
                                         [&](const cv::Point& point) { return length(cv::Point2d(point) - from); });
    }

    /// For each point of the outline: is it a cut between two pieces?
    [[nodiscard]] std::vector<bool> cuts() const
    {
        std::vector<bool> cut(contour_.size());
        for (std::size_t i = 0; i < contour_.size(); ++i)
            cut[i] = distance(contour_[i]) <= near_palm;
        std::vector<int> hull;
        cv::convexHull(contour_, hull);
        std::ranges::sort(hull);  // the order that convexityDefects requires for any outline
        std::vector<cv::Vec4i> defects;
        if (hull.size() > 3)
            cv::convexityDefects(contour_, hull, defects);
        for (const cv::Vec4i& defect : defects)
            if (defect[3] / 256.0 > defect_depth * hand_.radius)
                cut[static_cast<std::size_t>(defect[2])] = true;
        return cut;
    }

    /// A piece of the outline between two cuts, begin to end, both modulo its length.
    void take_piece(std::size_t begin, std::size_t end)
    {
        const std::size_t count = contour_.size();
        cv::Point tip = contour_[begin % count];
        for (std::size_t i = begin; i < end; ++i)
            if (distance(contour_[i % count]) > distance(tip))
                tip = contour_[i % count];
        const cv::Point left = contour_[begin % count], right = contour_[(end - 1) % count];
        const double width = length(left - right) / hand_.radius;
        const double length_seen = distance(tip) - std::max(distance(left), distance(right));
        if (width <= finger_width && length_seen >= finger_length
            && !at_border(tip))  // a cut-off piece may be anything
            fingers_.push_back({tip, distance(tip)});
        else if (width > finger_width) {
            arms_ += distance(tip) >= arm_reach ? 1 : 0;
            if (width > arm_width_) {
                arm_width_ = width;
                arm_ = (cv::Point2d(left) + cv::Point2d(right)) * 0.5;
            }
        }
    }

    void finish()
    {
        std::ranges::stable_sort(fingers_, std::ranges::greater{}, &Finger::reach);
        fingers_.resize(std::min<std::size_t>(fingers_.size(), 5));
        for (const Finger& finger : fingers_)
            hand_.tips.push_back(finger.tip);
        find_angle();
        const double start = hand_.angle.value_or(0) + 180;
        std::ranges::sort(hand_.tips, {}, [&](const cv::Point& tip) {
            return std::fmod(clockwise_from_up(tip - hand_.palm) - start + 720, 360);
        });
    }

    static double clockwise_from_up(const cv::Point2d& direction)
    {
        return std::atan2(direction.x, -direction.y) * 180 / std::numbers::pi;
    }

    /// Away from the arm; without one, where the fingers point.
    void find_angle()
    {
        cv::Point2d direction;
        if (arm_width_ > 0)
            direction = cv::Point2d(hand_.palm) - arm_;
        else
            for (const cv::Point& tip : hand_.tips)
                direction += cv::Point2d(tip - hand_.palm) * (1 / length(tip - hand_.palm));
        if (length(direction) > 0.1)
            hand_.angle = clockwise_from_up(direction);
    }

    Contour contour_;
    cv::Size image_;
    Hand hand_;
    std::vector<Finger> fingers_;
    double arm_width_ = 0;
    int arms_ = 0;
    cv::Point2d arm_;
};

}  // namespace

std::vector<Hand> GestureFinder::find(const cv::Mat& silhouette) const
{
    std::vector<Contour> contours;
    cv::findContours(cleaned(silhouette, smooth), contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    const double least = min_area / 100 * static_cast<double>(silhouette.total());
    std::erase_if(contours, [&](const Contour& contour) { return cv::contourArea(contour) < least; });
    std::ranges::stable_sort(contours, std::ranges::greater{},
                             [](const Contour& contour) { return cv::contourArea(contour); });
    contours.resize(std::min(contours.size(), static_cast<std::size_t>(max_hands)));
    std::vector<Hand> hands;
    for (Contour& contour : contours)
        if (Reading reading(std::move(contour), silhouette.size()); reading.radius() >= smallest_palm)
            hands.push_back(reading.read());
    return hands;
}

std::optional<GestureFinder::Read> GestureFinder::read_at(const cv::Mat& silhouette, cv::Point place,
                                                          double radius) const
{
    std::vector<Contour> contours;
    cv::findContours(cleaned(silhouette, smooth), contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    for (Contour& contour : contours)
        if (cv::pointPolygonTest(contour, place, false) >= 0) {
            Reading reading(std::move(contour), silhouette.size(), place, radius);
            if (reading.radius() < smallest_palm)
                return std::nullopt;
            Hand hand = reading.read();
            return Read{std::move(hand), reading.arms()};
        }
    return std::nullopt;
}

}  // namespace gesture
