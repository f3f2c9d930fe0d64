// Layouts told apart by their shapes, and tables of numbers to boxes.
#include <doctest/doctest.h>
#include <limits>
#include <model_output.hpp>

using detect::candidates;
using detect::Layout;
using detect::layout_of;

namespace {

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

TEST_CASE("model output: boxes that are none are left out")
{
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
    const cv::Mat output = table({1, 5, 6}, {nan, 1, 1, 1, 1, 1,     1, infinite, 1, 1, 1, 1, 1, 1, -3,
                                             1,   1, 1, 1, 1, 1e30F, 1, 1,        1, 5, 5, 2, 2, 1, nan});
    CHECK(candidates(output, Layout::rows, {100, 100}, 0.3).empty());
}
