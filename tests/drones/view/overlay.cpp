// The caption and the notice.
#include "overlay.hpp"

#include <doctest/doctest.h>
#include <opencv2/core.hpp>

using namespace std::chrono_literals;

namespace {

const std::chrono::system_clock::time_point noon{1'700'000'000s};

}  // namespace

TEST_CASE("overlay: the caption has sender, source, rate and age, and omits unknown values")
{
    view::Origin origin{"face.annotated", "camera", 7, {640, 480}, noon, 29.84};
    CHECK(view::caption(origin, noon + 12ms) == "face.annotated from camera  29.8 fps  12 ms");
    CHECK(view::caption(origin, noon + 3400ms) == "face.annotated from camera  29.8 fps  3.4 s");
    CHECK(view::caption(origin, noon + 59'900ms) == "face.annotated from camera  29.8 fps  59.9 s");
    CHECK(view::caption(origin, noon + 100s) == "face.annotated from camera  29.8 fps  2 min");
    CHECK(view::caption(origin, noon - 5ms) == "face.annotated from camera  29.8 fps  0 ms");
    origin.captured.reset();
    origin.rate = 0;
    CHECK(view::caption(origin, noon) == "face.annotated from camera");
    origin.sender = "camera.image";
    CHECK(view::caption(origin, noon) == "camera.image");
}

TEST_CASE("overlay: the caption covers a strip at the lower edge alone, and the image itself is not changed")
{
    for (const int type : {CV_8UC1, CV_8UC3}) {
        const cv::Mat image(480, 640, type, cv::Scalar::all(120)), before = image.clone();
        const cv::Mat drawn = view::with_caption(image, "camera.image  30.0 fps");
        CHECK(cv::norm(image, before) == 0);
        CHECK(drawn.size() == image.size());
        REQUIRE(drawn.type() == CV_8UC3);
        const cv::Mat upper = drawn.rowRange(0, 430), lower = drawn.rowRange(430, 480);
        CHECK(cv::norm(upper, cv::Mat(upper.size(), CV_8UC3, cv::Scalar::all(120)), cv::NORM_INF) == 0);
        double darkest = 0, brightest = 0;
        cv::minMaxLoc(lower.reshape(1), &darkest, &brightest);
        CHECK(darkest < 60);     // the strip
        CHECK(brightest > 200);  // the letters
    }
}

TEST_CASE("overlay: the letters shrink until the text fits the width")
{
    const auto right_edge = [](int width) {
        const cv::Mat drawn = view::with_caption(cv::Mat(480, width, CV_8UC3, cv::Scalar::all(0)),
                                                 "a-drone-with-a-long-name.annotated from camera-2  29.8 fps");
        cv::Mat columns;
        cv::reduce(drawn.reshape(1, drawn.rows), columns, 0, cv::REDUCE_MAX);
        std::vector<cv::Point> lit;
        cv::findNonZero(columns, lit);
        return lit.back().x / 3;
    };
    CHECK(right_edge(640) < 638);
    CHECK(right_edge(400) < 399);
}

TEST_CASE("overlay: images of every size can be captioned")
{
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 200), cv::Size(200, 3), cv::Size(4000, 2500)})
        CHECK(view::with_caption(cv::Mat(size, CV_8UC3, cv::Scalar::all(9)), "camera.image  30.0 fps").size() == size);
}

TEST_CASE("overlay: a notice shows its text")
{
    const cv::Mat empty = view::notice(""), text = view::notice("no image yet");
    CHECK(empty.size() == text.size());
    CHECK(cv::norm(empty, text) > 0);
}
