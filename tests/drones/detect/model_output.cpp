// Layouts told apart by their shapes, and tables of numbers to boxes.
#include <doctest/doctest.h>
#include <limits>
#include <model_output.hpp>

using detect::Candidate;
using detect::Layout;
using detect::Place;

namespace {

std::optional<Layout> layout_of(const std::vector<int>& shape, std::size_t classes, std::string_view wanted = {})
{
    const auto place = detect::layout_of({shape}, classes, wanted);
    return place ? std::optional(place->layout) : std::nullopt;
}

std::vector<Candidate> candidates(const cv::Mat& output, Layout layout, cv::Size input, double min_score)
{
    return detect::candidates({output}, {.layout = layout}, input, min_score);
}

cv::Mat table(const std::vector<int>& shape, std::vector<float> numbers)
{
    return cv::Mat(static_cast<int>(shape.size()), shape.data(), CV_32F, numbers.data()).clone();
}

}  // namespace

TEST_CASE("model output: the classes that were named tell the layouts apart")
{
    CHECK(layout_of({1, 25200, 85}, 80) == Layout::rows);
    CHECK(layout_of({1, 84, 8400}, 80) == Layout::columns);
    CHECK(layout_of({1, 1, 100, 7}, 80) == Layout::corners);
    CHECK(layout_of({1, 6, 12}, 2) == Layout::columns);
    CHECK(layout_of({1, 12, 6}, 1) == Layout::rows);
    CHECK(layout_of({1, 3, 85}, 80) == Layout::rows);  // fewer boxes than numbers
    CHECK_FALSE(layout_of({1, 84, 8400}, 79));
    CHECK_FALSE(layout_of({1, 8400, 84}, 80));
}

TEST_CASE("model output: without names the shorter side is one object; what cannot be one is refused")
{
    CHECK(layout_of({1, 25200, 85}, 0) == Layout::rows);
    CHECK(layout_of({1, 84, 8400}, 0) == Layout::columns);
    for (const std::vector<int>& shape :
         {std::vector<int>{1, 1000}, {1, 100, 4}, {1, 4, 100}, {2, 84, 8400}, {1, 3, 80, 80}, {2, 1, 100, 7}, {}})
        CHECK_FALSE(layout_of(shape, 0));
    CHECK(detect::shape_text({1, 84, 8400}) == "1x84x8400");
}

TEST_CASE("model output: rows have an objectness, which counts; the best class wins")
{
    const cv::Mat output = table(
        {1, 3, 7}, {50, 40, 20, 10, 0.5F, 0.2F, 0.8F, 10, 10, 4, 4, 0.9F, 0.9F, 0.1F, 10, 10, 4, 4, 0.1F, 0.9F, 0.1F});
    const auto found = candidates(output, Layout::rows, {100, 100}, 0.3);
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
    const auto found = candidates(output, Layout::columns, {100, 100}, 0.3);
    REQUIRE(found.size() == 2);
    CHECK(found[0].box == cv::Rect2d(40, 35, 20, 10));
    CHECK(found[0].class_index == 1);
    CHECK(found[0].score == doctest::Approx(0.8));
    CHECK(found[1].class_index == 0);
}

TEST_CASE("model output: corners are shares of the input, and rows of no picture end nothing")
{
    const cv::Mat output =
        table({1, 1, 3, 7}, {-1, 1, 0.9F, 0, 0, 1, 1, 0, 15, 0.7F, 0.25F, 0.5F, 0.5F, 0.75F, 0, 3, 0.1F, 0, 0, 1, 1});
    const auto found = candidates(output, Layout::corners, {400, 200}, 0.3);
    REQUIRE(found.size() == 1);
    CHECK(found[0].box == cv::Rect2d(100, 100, 100, 50));
    CHECK(found[0].class_index == 15);
    CHECK(found[0].score == doctest::Approx(0.7));
}

TEST_CASE("model output: six numbers and few rows are a finished list, unless one class was named; more are places to "
          "look at")
{
    CHECK(layout_of({1, 300, 6}, 0) == Layout::finished);
    CHECK(layout_of({1, 300, 6}, 80) == Layout::finished);
    CHECK(layout_of({1, 300, 6}, 1) == Layout::rows);
    CHECK(layout_of({1, 25200, 6}, 0) == Layout::rows);
    CHECK(layout_of({1, 6, 8400}, 2) == Layout::columns);
    CHECK(layout_of({100, 7}, 80) == Layout::numbered);
    CHECK(layout_of({1, 300, 6}, 1, "yolov10") == Layout::finished);
    CHECK(layout_of({1, 300, 6}, 0, "yolov5") == Layout::rows);
    CHECK_FALSE(layout_of({1, 300, 6}, 0, "ssd"));
    for (const Layout layout : {Layout::rows, Layout::columns, Layout::corners, Layout::finished, Layout::numbered})
        CHECK(detect::name_of(layout) != detect::name_of(Layout::apart));
}

TEST_CASE("model output: boxes and scores may be apart, in any order, with as many rows")
{
    CHECK(detect::layout_of({{1, 3000, 21}, {1, 3000, 4}}, 0) == Place{Layout::apart, 1, 0});
    CHECK(detect::layout_of({{1, 3000, 4}, {1, 3000, 21}}, 21) == Place{Layout::apart, 0, 1});
    CHECK_FALSE(detect::layout_of({{1, 3000, 4}, {1, 3000, 21}}, 20));
    CHECK_FALSE(detect::layout_of({{1, 3000, 4}, {1, 200, 3}}, 0));
    const std::vector<cv::Mat> outputs{table({1, 2, 3}, {0.1F, 0.2F, 0.7F, 0.9F, 0.05F, 0.05F}),
                                       table({1, 2, 4}, {0.25F, 0.5F, 0.5F, 0.75F, 0, 0, 1, 1})};
    const auto found = detect::candidates(outputs, {Layout::apart, 1, 0}, {400, 200}, 0.3);
    REQUIRE(found.size() == 1);  // the other one is background
    CHECK(found[0].box == cv::Rect2d(100, 100, 100, 50));
    CHECK(found[0].class_index == 2);
    CHECK(found[0].score == doctest::Approx(0.7));
}

TEST_CASE("model output: finished lists have corners in px, and class and score each at its place")
{
    auto found =
        candidates(table({1, 2, 6}, {10, 20, 40, 60, 0.8F, 3, 0, 0, 0, 0, 0, 0}), Layout::finished, {99, 99}, 0.3);
    REQUIRE(found.size() == 1);
    CHECK(found[0].box == cv::Rect2d(10, 20, 30, 40));
    CHECK(found[0].class_index == 3);
    found = candidates(table({1, 7}, {0, 10, 20, 40, 60, 5, 0.9F}), Layout::numbered, {99, 99}, 0.3);
    REQUIRE(found.size() == 1);
    CHECK(found[0].box == cv::Rect2d(10, 20, 30, 40));
    CHECK(found[0].class_index == 5);
    CHECK(found[0].score == doctest::Approx(0.9));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    CHECK(candidates(table({1, 2, 6}, {10, 20, 40, 60, 0.8F, nan, 10, 20, 5, 60, 0.8F, 1}), Layout::finished, {99, 99},
                     0.3)
              .empty());
}

TEST_CASE("model output: boxes that are none are left out")
{
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
    const cv::Mat output = table({1, 5, 6}, {nan, 1, 1, 1, 1, 1,     1, infinite, 1, 1, 1, 1, 1, 1, -3,
                                             1,   1, 1, 1, 1, 1e30F, 1, 1,        1, 5, 5, 2, 2, 1, nan});
    CHECK(candidates(output, Layout::rows, {100, 100}, 0.3).empty());
}
