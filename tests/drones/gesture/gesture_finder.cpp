// Masks made for one question each, and the photographs of hands.
#include <doctest/doctest.h>
#include <possible.hpp>
#include <gesture_finder.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <swarm.hpp>

using gesture::GestureFinder;

namespace {

cv::Mat empty_mask() { return cv::Mat::zeros(480, 640, CV_8UC1); }

/// A palm with its centre at 300,240, radius 50, and straight fingers upwards at these places.
cv::Mat mask_with_fingers(const std::vector<int>& places)
{
    cv::Mat mask = empty_mask();
    cv::circle(mask, {300, 240}, 50, 255, cv::FILLED);
    for (const int x : places)
        cv::rectangle(mask, cv::Rect(x, 100, 18, 120), 255, cv::FILLED);
    return mask;
}

/// What stands before the light wall right of the man in the photographs.
cv::Mat before_the_wall(const std::filesystem::path& photograph)
{
    cv::Mat grey = cv::imread(photograph.string(), cv::IMREAD_GRAYSCALE), mask;
    cv::GaussianBlur(grey(cv::Rect(324, 2, 315, 380)), grey, {}, 2);
    cv::threshold(grey, mask, 0, 255, cv::THRESH_BINARY_INV | cv::THRESH_OTSU);
    return mask;
}

}  // namespace

TEST_CASE("gesture finder: an empty mask, a full one and a speck have no hand with fingers")
{
    CHECK(GestureFinder().find(empty_mask()).empty());
    cv::Mat speck = empty_mask();
    speck(cv::Rect(100, 100, 20, 20)) = 255;
    CHECK(GestureFinder().find(speck).empty());
    const auto full = GestureFinder().find(cv::Mat(480, 640, CV_8UC1, cv::Scalar(255)));
    CHECK((full.empty() || full[0].tips.empty()));
}

TEST_CASE("gesture finder: images of any size are looked at")
{
    GestureFinder finder;
    finder.min_area = 0;
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 300), cv::Size(300, 1), cv::Size(3, 3), cv::Size(40, 40)}) {
        CHECK_NOTHROW(static_cast<void>(finder.find(cv::Mat(size, CV_8UC1, cv::Scalar(255)))));
        cv::Mat noise(size, CV_8UC1);
        cv::randu(noise, 0, 2);
        CHECK_NOTHROW(static_cast<void>(finder.find(noise)));
    }
}

TEST_CASE("gesture finder: fingertips are where the fingers end, clockwise, and the mask is not changed")
{
    const cv::Mat mask = mask_with_fingers({250, 291, 332}), before = mask.clone();
    const auto hands = GestureFinder().find(mask);
    REQUIRE(hands.size() == 1);
    CHECK(gesture::pose(hands[0]) == "three");
    CHECK(cv::norm(hands[0].palm - cv::Point(300, 240)) < 8);
    CHECK(hands[0].box.y == doctest::Approx(100).epsilon(0.02));
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(hands[0].tips[i].y <= 104);
        CHECK(std::abs(hands[0].tips[i].x - (259 + 41 * static_cast<int>(i))) <= 11);
    }
    REQUIRE(hands[0].angle);
    CHECK(*hands[0].angle == doctest::Approx(0).epsilon(1).scale(10));
    CHECK(cv::norm(mask, before, cv::NORM_INF) == 0);
}

TEST_CASE("gesture finder: fingers that separate only beyond the palm are counted by the defect between them")
{
    cv::Mat mask = mask_with_fingers({});
    cv::rectangle(mask, cv::Rect(278, 140, 44, 80), 255, cv::FILLED);  // one trunk, 1.9 radii high
    for (const int x : {278, 304})
        cv::rectangle(mask, cv::Rect(x, 95, 18, 60), 255, cv::FILLED);
    const auto hands = GestureFinder().find(mask);
    REQUIRE(hands.size() == 1);
    CHECK(hands[0].tips.size() == 2);
}

TEST_CASE("gesture finder: an arm that is as wide as the palm, and enters at the border, is not the palm")
{
    cv::Mat mask = mask_with_fingers({270, 312});
    cv::rectangle(mask, cv::Rect(262, 240, 76, 120), 255, cv::FILLED);
    cv::rectangle(mask, cv::Rect(246, 340, 108, 140), 255, cv::FILLED);  // wider than the palm
    const auto hands = GestureFinder().find(mask);
    REQUIRE(hands.size() == 1);
    CHECK(cv::norm(hands[0].palm - cv::Point(300, 240)) < 25);
    CHECK(hands[0].tips.size() == 2);
}

TEST_CASE("gesture finder: of several silhouettes the largest are read, the largest first")
{
    cv::Mat mask = mask_with_fingers({291});
    cv::circle(mask, {100, 350}, 40, 255, cv::FILLED);
    GestureFinder finder;
    CHECK(finder.find(mask).size() == 1);
    finder.max_hands = 4;
    const auto hands = finder.find(mask);
    REQUIRE(hands.size() == 2);
    CHECK(gesture::pose(hands[0]) == "one");
    CHECK(gesture::pose(hands[1]) == "fist");
    finder.min_area = 2;
    CHECK(finder.find(mask).size() == 1);
}

TEST_CASE("gesture finder: a tenth of all pixels wrong changes no count")
{
    cv::RNG random(5);
    for (const std::vector<int>& places : {std::vector<int>{}, {291}, {270, 312}, {250, 291, 332}}) {
        cv::Mat mask = mask_with_fingers(places), dice(mask.size(), CV_8UC1);
        random.fill(dice, cv::RNG::UNIFORM, 0, 100);
        cv::bitwise_xor(mask, dice < 10, mask);
        const auto hands = GestureFinder().find(mask);
        REQUIRE(hands.size() == 1);
        CHECK(hands[0].tips.size() == places.size());
    }
}

TEST_CASE("gesture finder: the photographed open hand and V sign before a light wall are read as such (needs media)")
{
    const auto media = hive::test::shared_data("media/hand_5_fingers.jpg");
    if (!hive::test::possible(media ? "" : "the photographs in the folder that HIVE_SHARED names"))
        return;
    const auto five = GestureFinder().find(before_the_wall(*media)),
               two = GestureFinder().find(before_the_wall(media->parent_path() / "hand_2_fingers.jpg"));
    REQUIRE(five.size() == 1);
    REQUIRE(two.size() == 1);
    CHECK(gesture::pose(five[0]) == "open");
    CHECK(gesture::pose(two[0]) == "two");
}

TEST_CASE("hand: draw marks the palm and nothing far from the hand")
{
    cv::Mat image = cv::Mat::zeros(480, 640, CV_8UC3);
    gesture::draw(image, GestureFinder().find(mask_with_fingers({291})));
    CHECK(cv::countNonZero(image.reshape(1)) > 500);
    CHECK(cv::countNonZero(image.colRange(400, 640).clone().reshape(1)) == 0);
}
