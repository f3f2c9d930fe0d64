// Distinguishes layouts by the shapes of the outputs, and by other information on the network.
#include "table.hpp"

#include <layouts.hpp>

#include <doctest/doctest.h>

#include <set>

using detect::Knowledge;
using Shapes = std::vector<std::vector<int>>;

namespace {

const cv::Size default_input(640, 640);

/// The likeliest layout; "none" without one.
std::string_view layout_of(const Shapes& shapes, const Knowledge& known, std::string_view wanted = {})
{
    const auto places = detect::places_in(shapes, known, wanted);
    return places.empty() ? "none" : places[0].layout->name;
}

std::string_view layout_of(const std::vector<int>& shape, std::size_t classes, std::string_view wanted = {})
{
    return layout_of(Shapes{shape}, Knowledge{.classes = classes, .input = default_input}, wanted);
}

std::string_view with_task(const Shapes& shapes, const char* task, std::size_t classes, int keypoints = 0)
{
    return layout_of(shapes,
                     Knowledge{.classes = classes, .input = default_input, .task = task, .keypoints = keypoints});
}

/// What speaks against the likeliest layout, and the layout that nothing speaks against.
std::pair<std::string, std::string_view> choice(const std::vector<cv::Mat>& outputs, std::size_t classes)
{
    Shapes shapes;
    for (const cv::Mat& output : outputs)
        shapes.emplace_back(output.size.p, output.size.p + output.dims);
    std::string first;
    for (const auto& place : detect::places_in(shapes, {.classes = classes, .input = default_input})) {
        const auto wrong = detect::objection(outputs, place);
        if (!wrong)
            return {first, place.layout->name};
        first = first.empty() ? *wrong : first;
    }
    return {first, "none"};
}

}  // namespace

TEST_CASE("layouts: each has a name of its own")
{
    std::set<std::string_view> names;
    for (const auto& layout : detect::layouts())
        CHECK(names.insert(layout.name).second);
    CHECK_THROWS_AS(static_cast<void>(detect::layout_named("yolov99")), std::out_of_range);
}

TEST_CASE("layouts: distinguished by the number of class names")
{
    CHECK(layout_of({1, 25200, 85}, 80) == "yolov5");
    CHECK(layout_of({1, 84, 8400}, 80) == "yolov8");
    CHECK(layout_of({1, 1, 100, 7}, 80) == "ssd");
    CHECK(layout_of({1, 6, 12}, 2) == "yolov8");
    CHECK(layout_of({1, 3, 85}, 80) == "yolov5");  // fewer boxes than numbers
    CHECK(layout_of({1, 300, 84}, 80) == "rt-detr");
    CHECK(layout_of({1, 84, 8400}, 79) == "none");
    CHECK(layout_of({1, 8400, 84}, 79) == "yolov5");
}

TEST_CASE("layouts: without names the shorter side is one object; an output that cannot be one is refused")
{
    CHECK(layout_of({1, 25200, 85}, 0) == "yolov5");
    CHECK(layout_of({1, 84, 8400}, 0) == "yolov8");
    for (const std::vector<int>& shape :
         {std::vector<int>{2, 1000}, {1, 100, 4}, {1, 4, 100}, {2, 84, 8400}, {1, 3, 80, 80}, {2, 1, 100, 7}, {}})
        CHECK(layout_of(shape, 0) == "none");
    CHECK(detect::shape_text({1, 84, 8400}) == "1x84x8400");
}

TEST_CASE("layouts: six numbers a row are a finished list, also of one class, unless the rows are the places at which "
          "YOLOv5 looks")
{
    for (const std::size_t classes : {0, 1, 2, 80})
        CHECK(layout_of({1, 300, 6}, classes) == "yolov10");
    CHECK(layout_of({1, 25200, 6}, 1) == "yolov5");
    CHECK(layout_of({1, 25200, 6}, 0) == "yolov5");
    const Knowledge small{.classes = 1, .input = {96, 96}};
    CHECK(layout_of({{1, 567, 6}}, small) == "yolov5");
    CHECK(layout_of({{1, 135, 6}}, small) == "yolov5");  // a tiny one
    CHECK(layout_of({{1, 300, 6}}, small) == "yolov10");
    CHECK(layout_of({1, 6, 8400}, 2) == "yolov8");
    CHECK(layout_of({100, 7}, 80) == "yolov7");
    CHECK(layout_of({1, 300, 6}, 0, "yolov5") == "yolov5");
    CHECK(layout_of({1, 300, 6}, 0, "ssd") == "none");
}

TEST_CASE("layouts: boxes and scores may be apart, in any order, with as many rows")
{
    const auto place = [](const Shapes& shapes, std::size_t classes) {
        return detect::places_in(shapes, {.classes = classes, .input = default_input});
    };
    const auto found = place({{1, 3000, 21}, {1, 3000, 4}}, 0);
    REQUIRE(!found.empty());
    CHECK(found[0]
          == detect::Place{.layout = &detect::layout_named("ssd-apart"), .boxes = 1, .scores = 0, .classes = 21});
    CHECK(place({{1, 3000, 4}, {1, 3000, 21}}, 21)[0].boxes == 0);
    CHECK(place({{1, 3000, 4}, {1, 200, 3}}, 0).empty());
}

TEST_CASE("layouts: three outputs of as many rows are boxes, classes and scores; classes are whole numbers")
{
    const cv::Mat boxes = table({1, 2, 4}, {10, 10, 20, 30, 0, 0, 5, 5}), labels = table({1, 2}, {3, 17}),
                  scores = table({1, 2}, {0.9F, 0.1F});
    for (const std::size_t classes : {0, 1, 20})
        CHECK(choice({labels, boxes, scores}, classes).second == "lists");
    CHECK(choice({table({4, 4}, std::vector<float>(16)), table({4, 1}, {1, 2, 3, 4}), table({1, 4}, {0, 0, 0, 1})}, 0)
              .second
          == "lists");
    CHECK(choice({scores, boxes, labels}, 0)
          == std::pair(std::string("as lists it gives a score of 3, which is not between 0 and 1"),
                       std::string_view("none")));
    CHECK(layout_of({{1, 0, 4}, {1, 0}, {1, 0}}, {.input = default_input}) == "lists");  // nothing is seen
    CHECK(layout_of({{1, 2, 4}, {1, 2}, {1, 3}}, {.input = default_input}) == "none");
}

TEST_CASE("layouts: with separate logits, the number of names shows whether the last class is \"no object\"")
{
    const std::vector<cv::Mat> outputs{table({1, 1, 3}, {-4, 2, 7}), table({1, 1, 4}, {0.5F, 0.5F, 0.2F, 0.2F})};
    CHECK(choice(outputs, 2).second == "detr");
    CHECK(choice(outputs, 3).second == "rt-detr-apart");
    const auto [reason, none] = choice(outputs, 0);
    CHECK(none == "none");
    CHECK(reason == "as ssd-apart it gives a score of -4, which is not between 0 and 1");
}

TEST_CASE("layouts: numbers that a layout cannot have speak against it")
{
    const cv::Mat scores = table({1, 1, 2}, {0.1F, 0.9F});
    CHECK(choice({scores, table({1, 1, 4}, {0.1F, 0.1F, 0.9F, 0.9F})}, 2).second == "ssd-apart");
    CHECK(choice({scores, table({1, 1, 4}, {100, 100, 200, 200})}, 2)
          == std::pair(std::string("as ssd-apart it gives a box of 100, which is not a share of the input"),
                       std::string_view("yolo-nas")));
    CHECK(choice({table({1, 1, 6}, {0.5F, 0.5F, 0.2F, 0.2F, 0.9F, 0.3F})}, 2)
          == std::pair(std::string("as yolov10 it gives a class of 0.3, which is not a whole number"),
                       std::string_view("rt-detr")));
    CHECK(choice({table({1, 3}, {0.2F, 0.3F, 0.5F})}, 0).second == "classify");
    CHECK(choice({table({1, 3}, {-1, 4, 2})}, 0).second == "classify-logits");
    // A pose whose task is not known: its keypoints are no scores.
    CHECK(choice({table({1, 8, 9}, std::vector<float>(72, 30))}, 0)
          == std::pair(std::string("as yolov8 it gives a score of 30, which is not between 0 and 1"),
                       std::string_view("none")));
}

TEST_CASE("layouts: masks are recognized by the outputs, keypoints and angles by the task")
{
    const std::vector<int> prototypes{1, 32, 160, 160};
    CHECK(layout_of({{1, 116, 8400}, prototypes}, {.classes = 80, .input = default_input}) == "yolov8-seg");
    CHECK(layout_of({{1, 116, 8400}, prototypes}, {.classes = 0, .input = default_input}) == "yolov8-seg");
    CHECK(layout_of({{1, 25200, 117}, prototypes}, {.classes = 80, .input = default_input}) == "yolov5-seg");
    CHECK(with_task({{1, 300, 38}, prototypes}, "segment", 80) == "yolo26-seg");
    CHECK(with_task({{1, 56, 8400}}, "pose", 1, 17) == "yolov8-pose");
    CHECK(with_task({{1, 300, 57}}, "pose", 1, 17) == "yolo26-pose");
    CHECK(with_task({{1, 56, 8400}}, "pose", 1, 16) == "none");
    CHECK(with_task({{1, 20, 21504}}, "obb", 15) == "yolov8-obb");
    CHECK(with_task({{1, 300, 7}}, "obb", 15) == "yolo26-obb");
    CHECK(with_task({{1, 1000}}, "classify", 1000) == "classify");
    CHECK(with_task({{1, 7}}, "classify", 7) == "classify");
    CHECK(layout_of({1, 7}, 7) == "classify");
    CHECK(with_task({{1, 84, 8400}}, "detect", 80) == "yolov8");
    CHECK(layout_of({1, 20, 21504}, 15) == "none");
    CHECK(layout_of({1, 20, 21504}, 15, "yolov8-obb") == "yolov8-obb");
    CHECK(layout_of({1, 56, 8400}, 1, "yolov8-pose") == "yolov8-pose");
}
