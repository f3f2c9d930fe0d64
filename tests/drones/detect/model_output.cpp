// Converts the output tables of networks to candidates.
#include "table.hpp"

#include <model_output.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

using detect::Candidate;

namespace {

std::vector<Candidate> candidates(const cv::Mat& output, std::string_view layout, cv::Size input, double min_score,
                                  int classes = 0)
{
    return detect::candidates({output}, {.layout = &detect::layout_named(layout), .classes = classes}, input,
                              min_score);
}

}  // namespace

TEST_CASE("model output: rows have an objectness, which counts; the best class wins")
{
    const cv::Mat output = table(
        {1, 3, 7}, {50, 40, 20, 10, 0.5F, 0.2F, 0.8F, 10, 10, 4, 4, 0.9F, 0.9F, 0.1F, 10, 10, 4, 4, 0.1F, 0.9F, 0.1F});
    const auto found = candidates(output, "yolov5", {100, 100}, 0.3, 2);
    REQUIRE(found.size() == 2);
    CHECK(found[0].box == cv::Rect2d(40, 35, 20, 10));
    CHECK(found[0].class_index == 1);
    CHECK(found[0].score == doctest::Approx(0.4));
    CHECK(found[1].class_index == 0);
    CHECK(found[1].score == doctest::Approx(0.81));
}

TEST_CASE("model output: columns have no objectness")
{
    const cv::Mat output =
        table({1, 6, 3}, {50, 10, 90, 40, 10, 90, 20, 4, 8, 10, 4, 8, 0.2F, 0.9F, 0.1F, 0.8F, 0.1F, 0.1F});
    const auto found = candidates(output, "yolov8", {100, 100}, 0.3, 2);
    REQUIRE(found.size() == 2);
    CHECK(found[0].box == cv::Rect2d(40, 35, 20, 10));
    CHECK(found[0].class_index == 1);
    CHECK(found[0].score == doctest::Approx(0.8));
    CHECK(found[1].class_index == 0);
}

TEST_CASE("model output: corners are shares of the input, and rows of no image end nothing")
{
    const cv::Mat output =
        table({1, 1, 3, 7}, {-1, 1, 0.9F, 0, 0, 1, 1, 0, 15, 0.7F, 0.25F, 0.5F, 0.5F, 0.75F, 0, 3, 0.1F, 0, 0, 1, 1});
    const auto found = candidates(output, "ssd", {400, 200}, 0.3);
    REQUIRE(found.size() == 1);
    CHECK(found[0].box == cv::Rect2d(100, 100, 100, 50));
    CHECK(found[0].class_index == 15);
    CHECK(found[0].score == doctest::Approx(0.7));
}

TEST_CASE("model output: boxes and scores may be apart, and the first class may be the background")
{
    const std::vector<cv::Mat> outputs{table({1, 2, 3}, {0.1F, 0.2F, 0.7F, 0.9F, 0.05F, 0.05F}),
                                       table({1, 2, 4}, {0.25F, 0.5F, 0.5F, 0.75F, 0, 0, 1, 1})};
    const auto found = detect::candidates(
        outputs, {.layout = &detect::layout_named("ssd-apart"), .boxes = 1, .scores = 0, .classes = 3}, {400, 200},
        0.3);
    REQUIRE(found.size() == 1);  // the other one is background
    CHECK(found[0].box == cv::Rect2d(100, 100, 100, 50));
    CHECK(found[0].class_index == 2);
    CHECK(found[0].score == doctest::Approx(0.7));
}

TEST_CASE("model output: finished lists have corners in px, and class and score each at its place")
{
    auto found = candidates(table({1, 2, 6}, {10, 20, 40, 60, 0.8F, 3, 0, 0, 0, 0, 0, 0}), "yolov10", {99, 99}, 0.3);
    REQUIRE(found.size() == 1);
    CHECK(found[0].box == cv::Rect2d(10, 20, 30, 40));
    CHECK(found[0].class_index == 3);
    found = candidates(table({1, 7}, {0, 10, 20, 40, 60, 5, 0.9F}), "yolov7", {99, 99}, 0.3);
    REQUIRE(found.size() == 1);
    CHECK(found[0].box == cv::Rect2d(10, 20, 30, 40));
    CHECK(found[0].class_index == 5);
    CHECK(found[0].score == doctest::Approx(0.9));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    CHECK(candidates(table({1, 2, 6}, {10, 20, 40, 60, 0.8F, nan, 10, 20, 5, 60, 0.8F, 1}), "yolov10", {99, 99}, 0.3)
              .empty());
}

TEST_CASE("model output: boxes that are none are left out")
{
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
    const cv::Mat output = table({1, 5, 6}, {nan, 1, 1, 1, 1, 1,     1, infinite, 1, 1, 1, 1, 1, 1, -3,
                                             1,   1, 1, 1, 1, 1e30F, 1, 1,        1, 5, 5, 2, 2, 1, nan});
    CHECK(candidates(output, "yolov5", {100, 100}, 0.3, 1).empty());
}

TEST_CASE("model output: an output without rows is of an image in which nothing is seen")
{
    const int shape[] = {1, 0, 6};
    CHECK(candidates(cv::Mat(3, shape, CV_32F), "yolov10", {99, 99}, 0.3).empty());
}

TEST_CASE("model output: a score above 1 is invalid, except for rounding in half precision")
{
    const cv::Mat output = table({1, 1, 6}, {10, 20, 40, 60, 7.5F, 3}),
                  rounded = table({1, 1, 6}, {10, 20, 40, 60, 1.0005F, 3});
    CHECK_THROWS_WITH_AS(candidates(output, "yolov10", {99, 99}, 0.3),
                         "the model returns a score of 7.500000, above 1: its layout is not yolov10",
                         std::runtime_error);
    CHECK(candidates(rounded, "yolov10", {99, 99}, 0.3).size() == 1);
}

TEST_CASE("model output: DETR's logits become scores, by softmax without the last class or by a sigmoid; its boxes are "
          "centres as shares")
{
    const cv::Mat boxes = table({1, 2, 4}, {0.5F, 0.5F, 0.25F, 0.5F, 0.1F, 0.1F, 0.1F, 0.1F});
    const cv::Mat logits = table({1, 2, 3}, {0, 3, 0, 1, 1, 9});  // the second one sees nothing
    const auto read = [&](const char* name) {
        return detect::candidates({logits, boxes},
                                  {.layout = &detect::layout_named(name), .boxes = 1, .scores = 0, .classes = 3},
                                  {400, 200}, 0.3);
    };
    const auto softmax = read("detr");
    REQUIRE(softmax.size() == 1);
    CHECK(softmax[0].box == cv::Rect2d(150, 50, 100, 100));
    CHECK(softmax[0].class_index == 1);
    CHECK(softmax[0].score == doctest::Approx(std::exp(3) / (std::exp(3) + 2)));
    const auto sigmoid = read("rt-detr-apart");
    REQUIRE(sigmoid.size() == 2);
    CHECK(sigmoid[0].score == doctest::Approx(1 / (1 + std::exp(-3))));
    CHECK(sigmoid[1].class_index == 2);
}

TEST_CASE("model output: what follows the classes is an angle, keypoints or coefficients of a mask")
{
    // One object in a column: its box, two classes, and one or three numbers more.
    const cv::Mat turned = table({1, 7, 1}, {50, 40, 20, 10, 0.1F, 0.9F, 0.5F}),
                  pose = table({1, 9, 1}, {50, 40, 20, 10, 0.1F, 0.9F, 45, 38, 0.7F});
    const auto angle = candidates(turned, "yolov8-obb", {99, 99}, 0.3, 2);
    REQUIRE(angle.size() == 1);
    CHECK(angle[0].class_index == 1);
    CHECK(angle[0].angle == 0.5);
    CHECK(angle[0].extra.empty());
    for (const char* layout : {"yolov8-pose", "yolov8-seg"})
        CHECK(candidates(pose, layout, {99, 99}, 0.3, 2).at(0).extra == std::vector<float>{45, 38, 0.7F});
    const auto listed = candidates(table({1, 1, 7}, {50, 40, 20, 10, 0.9F, 3, 0.5F}), "yolo26-obb", {99, 99}, 0.3);
    REQUIRE(listed.size() == 1);
    CHECK(listed[0].box == cv::Rect2d(40, 35, 20, 10));  // centre and size, unlike other finished lists
    CHECK(listed[0].angle == 0.5);
}

TEST_CASE("model output: a classifier sees each class in the whole input")
{
    const auto plain = candidates(table({1, 3}, {0.1F, 0.6F, 0.3F}), "classify", {40, 20}, 0.25, 3);
    REQUIRE(plain.size() == 2);
    CHECK(plain[0].box == cv::Rect2d(0, 0, 40, 20));
    CHECK(plain[0].class_index == 1);
    CHECK(plain[1].score == doctest::Approx(0.3));
    const auto logits = candidates(table({1, 3}, {1, 5, -2}), "classify-logits", {40, 20}, 0.5, 3);
    REQUIRE(logits.size() == 1);
    CHECK(logits[0].score == doctest::Approx(1 / (1 + std::exp(-4) + std::exp(-7))));
}
