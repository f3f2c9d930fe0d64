// The search for hands: next to a face, by a region, and by the default colours; drawn ones, and photographs.
#include <doctest/doctest.h>
#include <possible.hpp>
#include <drawn_face.hpp>
#include <drawn_hand.hpp>
#include <hand_search.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <scene.hpp>
#include <swarm.hpp>

#include <cmath>

using gesture::HandSearch;
using gesture::SkinColour;

namespace {

constexpr const char* cascade = "/usr/share/opencv4/haarcascades/haarcascade_frontalface_alt2.xml";

/// A grey room with sensor noise.
cv::Mat room()
{
    cv::Mat image(480, 640, CV_8UC3, cv::Scalar(140, 135, 125)), noise(image.size(), CV_16SC3);
    cv::RNG(4).fill(noise, cv::RNG::NORMAL, 0, 3);
    cv::add(image, noise, image, cv::noArray(), CV_8U);
    return image;
}

camera::DrawnHand hand_at(cv::Point2d palm, int fingers)
{
    camera::DrawnHand hand;
    hand.palm = palm;
    hand.radius = 36;
    hand.fingers = fingers;
    hand.arm = 3;
    return hand;
}

/// The hand of the scene has another colour than its faces; this one belongs to a face.
void draw_hand_of_face(cv::Mat& image, const camera::DrawnHand& hand)
{
    cv::Mat drawn = cv::Mat::zeros(image.size(), CV_8UC3), brightness;
    camera::draw_hand(drawn, hand);
    cv::extractChannel(drawn, brightness, 2);
    for (int y = 0; y < image.rows; ++y)
        for (int x = 0; x < image.cols; ++x)
            if (const double level = brightness.at<unsigned char>(y, x) / 205.0; level > 0.6)
                image.at<cv::Vec3b>(y, x) = cv::Vec3b(cv::Vec3d(147, 171, 204) * level);
}

bool is_there(const gesture::Hand& hand, const camera::DrawnHand& truth)
{
    return std::hypot(hand.palm.x - truth.palm.x, hand.palm.y - truth.palm.y) < 0.4 * truth.radius;
}

}  // namespace

TEST_CASE("skin colour: it is learnt from most of the pixels, and knows its own kind")
{
    cv::Mat image = room();
    image(cv::Rect(100, 100, 60, 60)) = cv::Scalar(110, 150, 205);
    image(cv::Rect(100, 100, 60, 15)) = cv::Scalar(20, 20, 20);  // hair
    cv::Mat where = cv::Mat::zeros(image.size(), CV_8UC1);
    where(cv::Rect(100, 100, 60, 60)) = 255;
    const auto skin = SkinColour::learn(image, where, {20, 4});
    REQUIRE(skin);
    const cv::Mat mask = skin->mask(image, 3);
    CHECK(cv::countNonZero(mask(cv::Rect(100, 116, 60, 44))) == 60 * 44);
    CHECK(cv::countNonZero(mask) < 60 * 60);
    CHECK(skin->distance(*skin) == 0);
    const auto wall = SkinColour::learn(image, 255 - where, {20, 4});
    REQUIRE(wall);
    CHECK(skin->distance(*wall) > 3);
    CHECK_FALSE(SkinColour::learn(image, cv::Mat::zeros(image.size(), CV_8UC1), {20, 4}));
}

TEST_CASE("hand search: next to a face the hand is found and its fingers are counted; the face is not a hand")
{
    HandSearch search;
    search.load_faces(cascade);
    for (int fingers = 1; fingers <= 5; ++fingers) {
        CAPTURE(fingers);
        cv::Mat image = room();
        camera::draw_face(image, {80, 150, 140, 140});
        const auto truth = hand_at({440, 220}, fingers);
        draw_hand_of_face(image, truth);
        const auto hands = search.find(image);
        REQUIRE(hands.size() == 1);
        CHECK(is_there(hands[0], truth));
        CHECK(hands[0].tips.size() == static_cast<std::size_t>(fingers));
    }
}

TEST_CASE("hand search: a fist on an arm is a hand; a plate, a ball and an elbow of the colour of skin are none")
{
    HandSearch search;
    search.load_faces(cascade);
    cv::Mat empty = room();
    camera::draw_face(empty, {80, 150, 140, 140});
    const cv::Scalar skin(147, 171, 204);
    cv::Mat image = empty.clone();
    SUBCASE("fist")
    {
        const auto truth = hand_at({440, 220}, 0);
        draw_hand_of_face(image, truth);
        const auto hands = search.find(image);
        REQUIRE(hands.size() == 1);
        CHECK(is_there(hands[0], truth));
        CHECK(hands[0].tips.empty());
        return;
    }
    SUBCASE("plate") { cv::rectangle(image, {400, 180, 90, 70}, skin, cv::FILLED); }
    SUBCASE("ball") { cv::circle(image, {440, 220}, 38, skin, cv::FILLED); }
    SUBCASE("elbow")
    {
        cv::line(image, {639, 100}, {440, 240}, skin, 64, cv::LINE_AA);
        cv::line(image, {440, 240}, {639, 400}, skin, 64, cv::LINE_AA);
    }
    CHECK(search.find(image).empty());
}

TEST_CASE("hand search: a region of skin is enough, and an object of another colour is not a hand")
{
    HandSearch search;
    cv::Mat image = room();
    const auto truth = hand_at({440, 220}, 3);
    camera::draw_hand(image, truth);
    cv::circle(image, {150, 240}, 40, {60, 60, 200}, cv::FILLED);  // a red ball
    search.region = {425, 205, 30, 30};
    const auto hands = search.find(image);
    REQUIRE(hands.size() == 1);
    CHECK(is_there(hands[0], truth));
    CHECK(hands[0].tips.size() == 3);
    search.region = {5000, 5000, 30, 30};  // outside: the usual colours
    CHECK_FALSE(search.find(image).empty());
}

TEST_CASE("hand search: several hands, up to the requested number; none in an empty room")
{
    HandSearch search;
    search.load_faces(cascade);
    CHECK(search.find(room()).empty());
    cv::Mat image = room();
    camera::draw_hand(image, hand_at({160, 220}, 2));
    camera::draw_hand(image, hand_at({460, 220}, 5));
    CHECK(search.find(image).size() == 1);
    search.max_hands = 8;
    const auto hands = search.find(image);
    REQUIRE(hands.size() == 2);
    CHECK(hands[0].tips.size() + hands[1].tips.size() == 7);
}

TEST_CASE("hand search: of the scene with a plain wall it finds every hand, counts nearly all fingers, and sees none "
          "where none is")
{
    camera::SceneSettings settings;
    settings.background = camera::Background::plain;
    settings.faces = 0;
    settings.hand = true;
    const camera::Scene scene(settings);
    HandSearch search;
    search.load_faces(cascade);
    int found = 0, right = 0, shown = 0;
    for (int index = 10; index < 210; index += 15) {
        const auto image = scene.frame(index);
        const auto hands = search.find(image.image);
        CAPTURE(index);
        if (image.hands.empty()) {
            CHECK(hands.empty());
            continue;
        }
        ++shown;
        const bool there = !hands.empty() && is_there(hands[0], image.hands[0]);
        found += there ? 1 : 0;
        right += there && hands[0].tips.size() == static_cast<std::size_t>(image.hands[0].fingers) ? 1 : 0;
    }
    MESSAGE(right, " of ", shown, " hands of the scene are read right");
    CHECK(found == shown);
    CHECK(right >= shown - 1);
}

TEST_CASE("hand search: images of any size are looked at")
{
    HandSearch search;
    search.load_faces(cascade);
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 300), cv::Size(300, 1), cv::Size(40, 40)})
        for (const cv::Scalar& colour : {cv::Scalar(110, 150, 205), cv::Scalar::all(0)})
            CHECK_NOTHROW(static_cast<void>(search.find(cv::Mat(size, CV_8UC3, colour))));
}

TEST_CASE("hand search: a missing or invalid cascade is refused in a sentence")
{
    HandSearch search;
    CHECK_THROWS_WITH_AS(search.load_faces("/nowhere.xml"),
                         "no cascade at /nowhere.xml (Debian: apt install opencv-data)", std::runtime_error);
    CHECK_THROWS_AS(search.load_faces("/etc/hostname"), std::runtime_error);
    CHECK_NOTHROW(search.load_faces(""));
}

TEST_CASE("hand search: of the photographs half are read right, where none were by their silhouettes (needs media)")
{
    const auto media = hive::test::shared_data("media");
    if (!hive::test::possible(media ? "" : "the photographs in the folder that HIVE_SHARED names"))
        return;
    HandSearch search;
    search.load_faces(cascade);
    int right = 0;
    constexpr std::size_t none = 6;  // fingers
    const std::vector<std::pair<const char*, std::size_t>> photographs{
        {"hand_5_fingers.jpg", 5},    {"hand_2_fingers.jpg", 2},   {"hand_four_06aa.jpg", 4},
        {"hand_four_077f.jpg", 4},    {"hand_rock_026f.jpg", 2},   {"hand_rock_055f.jpg", 2},
        {"hand_none_00af.jpg", none}, {"hand_none_00b8.jpg", none}};
    for (const auto& [name, fingers] : photographs) {
        const auto hands = search.find(cv::imread((*media / name).string()));
        right += (hands.empty() ? none : hands[0].tips.size()) == fingers ? 1 : 0;
    }
    MESSAGE(right, " of ", photographs.size(), " photographs are read right");
    CHECK(right >= 5);
}
