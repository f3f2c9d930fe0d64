// What is drawn, looked at pixel by pixel.
#include <drawing.hpp>

#include <doctest/doctest.h>
#include <opencv2/imgproc.hpp>

#include <limits>
#include <set>

using annotate::Drawing;
using annotate::Mark;
using annotate::Marks;
using annotate::Shape;

namespace {

const cv::Vec3b black(0, 0, 0), green(60, 220, 60);

cv::Mat drawn(const Marks& marks, const Drawing& drawing = {},
              const cv::Mat& image = cv::Mat(200, 300, CV_8UC3, cv::Scalar::all(0)))
{
    cv::Mat result;
    drawing.draw(image, marks, result);
    return result;
}

cv::Vec3b at(const cv::Mat& image, int x, int y) { return image.at<cv::Vec3b>(y, x); }

cv::Vec3b bytes(const cv::Scalar& colour)
{
    return {static_cast<uchar>(colour[0]), static_cast<uchar>(colour[1]), static_cast<uchar>(colour[2])};
}

/// Pixels that are not black, in a part of the image.
int lit(const cv::Mat& image, const cv::Rect& part)
{
    int count = 0;
    for (int y = part.y; y < part.br().y; ++y)
        for (int x = part.x; x < part.br().x; ++x)
            count += at(image, x, y) != black;
    return count;
}

}  // namespace

TEST_CASE("drawing: a box is framed and nothing else is touched, nor is the image that came in")
{
    const cv::Mat before(200, 300, CV_8UC3, cv::Scalar::all(0));
    const auto image = drawn({.all = {{.box = {100, 50, 80, 60}}}}, {}, before);
    CHECK(at(image, 100, 80) == green);
    CHECK(at(image, 140, 50) == green);
    CHECK(at(image, 140, 80) == black);
    CHECK(at(image, 90, 80) == black);
    CHECK(at(image, 200, 80) == black);
    CHECK(lit(before, {0, 0, 300, 200}) == 0);
}

TEST_CASE("drawing: without marks the image stays as it is, a grey one becomes BGR")
{
    CHECK(lit(drawn({}), {0, 0, 300, 200}) == 0);
    const auto image = drawn({.all = {{.box = {100, 50, 80, 60}}}}, {}, cv::Mat(200, 300, CV_8UC1, cv::Scalar::all(9)));
    CHECK(image.type() == CV_8UC3);
    CHECK(at(image, 140, 80) == cv::Vec3b(9, 9, 9));
    CHECK(at(image, 100, 80) == green);
}

TEST_CASE("drawing: marks of an image of another size are drawn where they belong")
{
    const auto image = drawn({.all = {{.box = {200, 100, 160, 120}}}, .seen = {600, 400}});
    CHECK(at(image, 100, 80) == green);
    CHECK(at(image, 140, 50) == green);
    CHECK(at(image, 200, 100) == black);
}

TEST_CASE("drawing: the thickness is that of the lines")
{
    Drawing thin;
    thin.thickness = 1;
    Drawing thick;
    thick.thickness = 9;
    const Marks marks{.all = {{.box = {100, 50, 80, 60}}}};
    CHECK(at(drawn(marks, thin), 103, 80) == black);
    CHECK(at(drawn(marks, thick), 103, 80) == green);
}

TEST_CASE(
    "drawing: a label stands above its box, inside where there is no room, and not at all when it is switched off")
{
    const cv::Rect above(100, 75, 60, 23), inside(103, 3, 60, 10);
    const Mark low{.box = {100, 100, 80, 60}, .label = "person"}, high{.box = {100, 0, 80, 60}, .label = "person"};
    CHECK(lit(drawn({.all = {low}}), above) > 500);
    CHECK(lit(drawn({.all = {high}}), inside) > 300);
    Drawing bare;
    bare.labels = false;
    CHECK(lit(drawn({.all = {low}}, bare), above) == 0);
    CHECK(lit(drawn({.all = {high}}, bare), inside) == 0);
}

TEST_CASE("drawing: in small images labels take less and less room, and never most of the image or of their box")
{
    const auto plate = [](cv::Size size, const std::string& label, const cv::Rect2d& box) {
        Drawing bare;
        bare.labels = false;
        const cv::Mat image(size, CV_8UC3, cv::Scalar::all(0));
        const Marks marks{.all = {{.box = box, .label = label}}};
        cv::Mat changed;
        cv::absdiff(drawn(marks, {}, image), drawn(marks, bare, image), changed);
        cv::Mat points;
        cv::findNonZero(changed.reshape(1) > 0, points);
        return points.empty() ? cv::Rect() : cv::boundingRect(points);
    };
    const std::string label = "person #12 87 % 120 px/s";
    const auto large = plate({640, 480}, label, {200, 200, 100, 200}),
               small = plate({320, 240}, label, {100, 100, 50, 100}),
               smaller = plate({160, 120}, label, {50, 50, 25, 50});
    CHECK(large.width > small.width);
    CHECK(small.width > smaller.width);
    CHECK(smaller.width > 0);
    CHECK(small.width <= 3 * 320 / 2);  // three channels in a row
    CHECK(smaller.width <= 3 * 160 / 2);
    CHECK(plate({64, 48}, label, {20, 20, 20, 20}).empty());
    CHECK(plate({640, 480}, label, {200, 2, 60, 20}).y >= 22);  // inside it would hide its box
    CHECK_FALSE(plate({640, 480}, label, {200, 2, 60, 200}).empty());
}

TEST_CASE("drawing: a label at the right edge is moved into the image")
{
    const auto image = drawn({.all = {{.box = {290, 100, 8, 8}, .label = "somebody"}}});
    CHECK(lit(image, {230, 80, 40, 18}) > 400);
}

TEST_CASE(
    "drawing: labels stand next to each other where their boxes overlap, on top of all lines, and only at boxes in "
    "the image")
{
    const Mark one{.box = {100, 100, 80, 60}, .coloured_by = "1", .label = "first"},
        other{.box = {105, 103, 80, 60}, .coloured_by = "2", .label = "other"};
    const auto colours = [](const cv::Mat& image, const cv::Rect& part, const std::string& id) {
        cv::Mat found;
        const auto colour = Drawing::colour_of(id);
        cv::inRange(image(part), colour, colour, found);
        return cv::countNonZero(found);
    };
    const cv::Rect above(95, 75, 110, 25);
    const auto alone = drawn({.all = {one}}), both = drawn({.all = {one, other}});
    CHECK(colours(alone, above, "1") > 300);
    CHECK(colours(both, above, "1") == colours(alone, above, "1"));
    CHECK(colours(both, above, "2") == 0);
    CHECK(colours(both, {107, 105, 76, 25}, "2") > 200);  // inside its own box
    for (const cv::Rect2d outside : {cv::Rect2d(-60, 50, 40, 40), {320, 50, 40, 40}, {50, 205, 40, 40}})
        CHECK(lit(drawn({.all = {{.box = outside, .label = "outside"}}}), {0, 0, 300, 200}) == 0);
}

TEST_CASE("drawing: letters are white on a dark colour")
{
    const auto whitest = [](const char* id) {
        const auto image = drawn({.all = {{.box = {100, 100, 80, 60}, .coloured_by = id, .label = "MMMM"}}});
        cv::Mat found;
        cv::inRange(image(cv::Rect(100, 75, 80, 25)), cv::Scalar::all(200), cv::Scalar::all(255), found);
        return cv::countNonZero(found);
    };
    CHECK(whitest("7") > 10);  // blue
    CHECK(whitest("6") == 0);  // green
}

TEST_CASE("drawing: dots are small in a small box")
{
    const auto dot = [](double height) {
        const Mark mark{.box = {200, 20, 10, height}, .shapes = {{Shape::Form::dots, {{50, 50}}}}};
        return lit(drawn({.all = {mark}}), {40, 40, 20, 20});
    };
    CHECK(dot(20) < dot(120) / 2);
}

TEST_CASE("drawing: a line of a zone is seen in a white image, too")
{
    const cv::Mat white(200, 300, CV_8UC3, cv::Scalar::all(255));
    const auto image = drawn({.regions = {{{{0.1, 0.5}, {0.4, 0.5}, {0.4, 0.9}}, "", true}}}, {}, white);
    int darkest = 255;
    for (int y = 95; y < 105; ++y)
        darkest = std::min<int>(darkest, at(image, 75, y)[1]);
    CHECK(darkest < 100);
}

TEST_CASE("drawing: a trail is an open line, a hull a closed one, fingers are dots")
{
    const std::vector<cv::Point2d> corners{{20, 20}, {80, 20}, {80, 80}, {20, 80}};
    const auto shaped = [&](Shape::Form form) {
        return drawn({.all = {{.box = {250, 150, 10, 10}, .shapes = {{form, corners}}}}});
    };
    const auto trail = shaped(Shape::Form::line), hull = shaped(Shape::Form::outline), dots = shaped(Shape::Form::dots);
    for (const auto* image : {&trail, &hull})
        CHECK(at(*image, 50, 20) == green);
    CHECK(at(trail, 20, 50) == black);
    CHECK(at(hull, 20, 50) == green);
    CHECK(at(dots, 20, 20) == green);
    CHECK(at(dots, 50, 20) == black);
}

TEST_CASE("drawing: a mask is an area through which the image shows, and corners take the place of the box")
{
    const std::vector<cv::Point2d> corners{{20, 20}, {80, 20}, {80, 80}, {20, 80}};
    const cv::Mat grey(200, 300, CV_8UC3, cv::Scalar::all(100));
    const auto mask = drawn({.all = {{.box = {20, 20, 61, 61}, .shapes = {{Shape::Form::area, corners}}}}}, {}, grey);
    CHECK(at(mask, 50, 50) == cv::Vec3b(84, 148, 84));  // 40 % of green
    CHECK(at(mask, 50, 20) == green);
    CHECK(at(mask, 90, 50) == cv::Vec3b(100, 100, 100));
    const auto turned =
        drawn({.all = {{.box = {100, 100, 50, 50}, .shapes = {{Shape::Form::outline, corners}}, .framed = false}}});
    CHECK(at(turned, 50, 20) == green);
    CHECK(lit(turned, {95, 95, 60, 60}) == 0);
}

TEST_CASE("drawing: a track keeps its colour, and twenty tracks have at least eighteen")
{
    std::set<std::tuple<int, int, int>> colours;
    for (int id = 1; id <= 20; ++id) {
        const auto colour = bytes(Drawing::colour_of(std::to_string(id)));
        CHECK(colour == bytes(Drawing::colour_of(std::to_string(id))));
        CHECK(std::max({colour[0], colour[1], colour[2]}) == 255);
        colours.emplace(colour[0], colour[1], colour[2]);
    }
    CHECK(colours.size() >= 18);
    const auto image = drawn({.all = {{.box = {100, 50, 80, 60}, .coloured_by = "7"}}});
    CHECK(at(image, 100, 80) == bytes(Drawing::colour_of("7")));
    CHECK(bytes(Drawing::colour_of("")) == green);
}

TEST_CASE("drawing: tracks that follow one another have colours far apart")
{
    for (int id = 1; id <= 50; ++id)
        for (int next = id + 1; next <= id + 4; ++next) {
            const auto one = Drawing::colour_of(std::to_string(id)), other = Drawing::colour_of(std::to_string(next));
            CHECK(cv::norm(one - other) > 60);
        }
}

TEST_CASE("drawing: lines are wider in larger images")
{
    const Marks marks{.all = {{.box = {100, 50, 80, 60}}}};
    CHECK(at(drawn(marks), 103, 80) == black);
    CHECK(at(drawn(marks, {}, cv::Mat(2160, 3840, CV_8UC3, cv::Scalar::all(0))), 103, 80) == green);
    CHECK(at(drawn(marks, {}, cv::Mat(1920, 300, CV_8UC3, cv::Scalar::all(0))), 103, 80) == black);  // upright
}

TEST_CASE("drawing: letters are larger in larger images, up to 4K")
{
    const auto lit_above = [](cv::Size size) {
        const cv::Mat image(size, CV_8UC3, cv::Scalar::all(0));
        const Mark mark{.box = {100, size.height / 2.0, 50, 50}, .label = "person"};
        return lit(drawn({.all = {mark}}, {}, image), {100, 0, size.width - 100, size.height / 2 - 10});
    };
    CHECK(lit_above({1920, 1080}) > 3 * lit_above({960, 540}));
    CHECK(lit_above({3840, 2160}) > 3 * lit_above({1920, 1080}));
}

TEST_CASE("drawing: an uncertain mark is dashed, left out or solid")
{
    const cv::Rect side(100, 50, 80, 1);
    Mark mark{.box = {100, 50, 80, 60}, .uncertain = true};
    const auto with = [&](Drawing::Uncertain uncertain) {
        Drawing drawing;
        drawing.uncertain = uncertain;
        return lit(drawn({.all = {mark}}, drawing), side);
    };
    CHECK(with(Drawing::Uncertain::solid) == 80);
    CHECK(with(Drawing::Uncertain::dashed) > 30);
    CHECK(with(Drawing::Uncertain::dashed) < 60);
    CHECK(with(Drawing::Uncertain::hidden) == 0);
}

TEST_CASE("drawing: zones are outlines, lines have an arrow to their right")
{
    const auto image = drawn({.regions = {{{{0.1, 0.5}, {0.4, 0.5}, {0.4, 0.9}, {0.1, 0.9}}, "", true},
                                          {{{0.5, 0.3}, {0.9, 0.3}}, "", false}}});
    CHECK(at(image, 75, 100) == cv::Vec3b(235, 235, 235));
    CHECK(at(image, 75, 140) == black);
    CHECK(at(image, 200, 60) == cv::Vec3b(0, 220, 255));
    CHECK(lit(image, {190, 62, 40, 10}) > 5);
    CHECK(lit(image, {190, 40, 40, 18}) == 0);
}

TEST_CASE("drawing: what lies outside, or is turned inside out, harms nothing")
{
    const double far = 1e6;
    const Marks marks{.all = {{.box = {-far, -far, 2 * far, 2 * far}, .label = "all"},
                              {.box = {far, far, far, far},
                               .coloured_by = "1",
                               .label = "none",
                               .shapes = {{Shape::Form::outline, {{-far, 5}, {far, 7}}}}},
                              {.box = {50, 50, -20, -20}, .label = "inside out"},
                              {.box = {10, 10, 0, 0}, .shapes = {{Shape::Form::line, {{1, 1}}}}}}};
    const auto image = drawn(marks);
    CHECK(image.size() == cv::Size(300, 200));
    CHECK(lit(image, {100, 0, 100, 20}) > 0);  // the line from one side to the other
    CHECK(lit(drawn(marks, {}, cv::Mat(1, 1, CV_8UC3, cv::Scalar::all(0))), {0, 0, 1, 1}) >= 0);
}
