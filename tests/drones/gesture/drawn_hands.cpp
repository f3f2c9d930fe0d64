// Drawn hands of every kind: the fingers that were drawn are counted, and the hand of the scene matches its ground
// truth.
#include <doctest/doctest.h>
#include <drawn_hand.hpp>
#include <gesture_finder.hpp>
#include <hand_path.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <scene.hpp>
#include <silhouette.hpp>

#include <cmath>

using camera::DrawnHand;
using gesture::GestureFinder;
using gesture::Silhouette;

namespace {

/// How hands are drawn and seen.
struct Conditions {
    const char* name;
    double turned = 180;           ///< degrees at most, to either side
    double least = 35, most = 60;  ///< radius of the palm, px
    double arm = 30;               ///< in radii; 30: off the image
    double noise = 3;              ///< sensor noise, grey levels
    int quality = 80;              ///< of JPEG
};

DrawnHand random_hand(const Conditions& conditions, int fingers, cv::Size size, cv::RNG& random)
{
    DrawnHand hand;
    hand.radius = random.uniform(conditions.least, conditions.most);
    const double reach = 2.7 * hand.radius;  // a tip at the border is not counted
    hand.palm = {random.uniform(reach, size.width - reach), random.uniform(reach, size.height - reach)};
    hand.fingers = fingers;
    hand.rotation = random.uniform(-conditions.turned, conditions.turned);
    hand.arm = conditions.arm;
    return hand;
}

cv::Mat seen(const DrawnHand& hand, const Conditions& conditions, cv::RNG& random)
{
    cv::Mat image(480, 640, CV_8UC3, cv::Scalar::all(130)), noise(image.size(), CV_16SC3);
    camera::draw_hand(image, hand);
    random.fill(noise, cv::RNG::NORMAL, 0, conditions.noise);
    cv::add(image, noise, image, cv::noArray(), CV_8U);
    std::vector<unsigned char> jpeg;
    cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, conditions.quality});
    return cv::imdecode(jpeg, cv::IMREAD_COLOR);
}

double between(const cv::Point2d& a, const cv::Point2d& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Is it the hand that was drawn? Fingers exactly; the palm within a fifth of its radius, the angle within 8 degrees.
bool same_hand(const std::vector<gesture::Hand>& found, const DrawnHand& truth)
{
    return found.size() == 1 && found[0].tips.size() == static_cast<std::size_t>(truth.fingers)
           && between(found[0].palm, truth.palm) < 0.2 * truth.radius
           && std::abs(found[0].radius - truth.radius) < 0.2 * truth.radius
           && (!found[0].angle || std::abs(std::remainder(*found[0].angle - truth.rotation, 360)) < 8);
}

int exact(const Conditions& conditions, int each)
{
    Silhouette skin;
    skin.from = "skin";
    cv::RNG random(11);
    int right = 0;
    for (int fingers = 0; fingers <= 5; ++fingers)
        for (int i = 0; i < each; ++i) {
            const DrawnHand hand = random_hand(conditions, fingers, {640, 480}, random);
            right += same_hand(GestureFinder().find(skin.of(seen(hand, conditions, random))), hand) ? 1 : 0;
        }
    MESSAGE(std::string(conditions.name), ": ", right, " of ", 6 * each, " exactly right");
    return right;
}

}  // namespace

TEST_CASE("gesture finder: drawn hands are read exactly, at any rotation and with any end of the arm")
{
    CHECK(exact({.name = "upright, short arm", .turned = 15, .arm = 1.9}, 10) == 60);
    CHECK(exact({.name = "turned, arm off the image"}, 10) == 60);
    CHECK(exact({.name = "turned, short arm", .arm = 1.9}, 10) == 60);
}

TEST_CASE("gesture finder: large hands, noise and strong compression change nothing; small hands lose little")
{
    CHECK(exact({.name = "large", .turned = 20, .least = 60, .most = 85}, 5) == 30);
    CHECK(exact({.name = "noise 20, JPEG 30", .noise = 20, .quality = 30}, 5) == 30);
    CHECK(exact({.name = "small", .least = 20, .most = 35}, 10) >= 58);
}

TEST_CASE("gesture finder: without an arm the fingers give the direction")
{
    const Conditions conditions{.name = "no arm", .turned = 40, .arm = 0.5};
    Silhouette skin;
    skin.from = "skin";
    cv::RNG random(3);
    for (int fingers = 0; fingers <= 5; ++fingers) {
        const DrawnHand hand = random_hand(conditions, fingers, {640, 480}, random);
        const auto found = GestureFinder().find(skin.of(seen(hand, conditions, random)));
        REQUIRE(found.size() == 1);
        CHECK(found[0].tips.size() == static_cast<std::size_t>(fingers));
        CHECK(found[0].angle.has_value() == (fingers > 0));
        if (fingers > 0)
            CHECK(std::abs(std::remainder(*found[0].angle - hand.rotation, 360)) < 40);
    }
}

TEST_CASE("gesture finder: every gesture of the scene is read from a plain wall, and none where there is no hand")
{
    camera::SceneSettings settings;
    settings.background = camera::Background::plain;
    settings.faces = 0;
    settings.hand = true;
    const camera::Scene scene(settings);
    Silhouette skin;
    skin.from = "skin";
    int right = 0, looked_at = 0;
    for (int index = 0; index < 840; index += 6, ++looked_at) {
        const auto image = scene.frame(index);
        const auto found = GestureFinder().find(skin.of(image.image));
        right += image.hands.empty() ? found.empty() : same_hand(found, image.hands[0]);
    }
    CHECK(right == looked_at);
}

TEST_CASE("scene: the hand is away first, then shows the known sequence, fingers wholly inside")
{
    using camera::fingers_shown;
    using camera::frames_per_gesture;
    for (const cv::Size size : {cv::Size(64, 64), cv::Size(640, 480), cv::Size(480, 640), cv::Size(1280, 720)})
        for (int index = 0; index < 3 * frames_per_gesture * static_cast<int>(fingers_shown.size()); ++index) {
            const auto hand = camera::hand_at(index, size);
            const int shown =
                fingers_shown[static_cast<std::size_t>(index / frames_per_gesture) % fingers_shown.size()];
            REQUIRE(hand.has_value() == (shown != camera::no_hand));
            if (!hand)
                continue;
            CHECK(hand->fingers == shown);
            CHECK(hand->palm.x >= 2.6 * hand->radius);
            CHECK(hand->palm.x <= size.width - 2.6 * hand->radius);
            CHECK(hand->palm.y >= 2.6 * hand->radius);
            CHECK(hand->palm.y <= size.height - 2.6 * hand->radius);
        }
    CHECK(fingers_shown.front() == camera::no_hand);
}

TEST_CASE("drawn hand: what lies outside the image is cut off, not written")
{
    cv::Mat guarded(60, 60, CV_8UC3, cv::Scalar::all(9));
    cv::Mat inner = guarded(cv::Rect(20, 20, 20, 20));
    for (const cv::Point2d place : {cv::Point2d(-5, -5), cv::Point2d(10, 10), cv::Point2d(300, 300)})
        camera::draw_hand(inner, {.palm = place, .radius = 12});
    cv::Mat outside = guarded.clone();
    outside(cv::Rect(20, 20, 20, 20)).setTo(cv::Scalar::all(9));
    CHECK(cv::norm(outside, cv::Mat(60, 60, CV_8UC3, cv::Scalar::all(9)), cv::NORM_INF) == 0);
    CHECK(cv::norm(inner, cv::Mat(20, 20, CV_8UC3, cv::Scalar::all(9)), cv::NORM_INF) > 0);
}
