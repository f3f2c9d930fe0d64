// Reads marks from untrusted headers.
#include <marks.hpp>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <sstream>

using annotate::marks_in;
using annotate::Shape;
using nlohmann::json;

namespace {

const json box{{"x", 10}, {"y", 20}, {"w", 30}, {"h", 40}};

json with(const json& more)
{
    json object = box;
    object.update(more);
    return {{"things", json::array({object})}};
}

/// The block marked json on the drone's page.
json example()
{
    std::ifstream page(HIVE_SOURCE_DIR "/drones/annotate/README.md");
    std::stringstream text;
    text << page.rdbuf();
    const auto all = text.str();
    const auto begin = all.find("```json\n");
    REQUIRE(begin != std::string::npos);
    return json::parse(all.substr(begin + 8, all.find("```", begin + 8) - begin - 8));
}

}  // namespace

TEST_CASE("marks: what the face drone sends gives its boxes and the size of its image")
{
    const auto marks = marks_in({{"faces", {box, box}}, {"width", 640}, {"height", 480}});
    REQUIRE(marks.all.size() == 2);
    CHECK(marks.all[0].box == cv::Rect2d(10, 20, 30, 40));
    CHECK(marks.all[0].label.empty());
    CHECK(marks.seen == cv::Size2d(640, 480));
    CHECK(marks_in({{"faces", json::array()}, {"width", 640}, {"height", 480}}).all.empty());
}

TEST_CASE("marks: every field that holds boxes is taken, an object alone as well")
{
    const auto marks = marks_in({{"tracks", {box}}, {"hands", {box}}, {"hand", box}, {"note", "none"}, {"n", 3}});
    CHECK(marks.all.size() == 3);
    CHECK(marks.seen.empty());
}

TEST_CASE("marks: the label has class, id, score and speed")
{
    const auto marks = marks_in(with({{"class", "person"}, {"id", 3}, {"score", 0.874}, {"speed", 12.4}}));
    REQUIRE(marks.all.size() == 1);
    CHECK(marks.all[0].coloured_by == "3");
    CHECK(marks.all[0].label == "person #3 87 % 12 px/s");
    CHECK(marks_in(with({{"class", "person"}})).all[0].coloured_by == "person");
    CHECK(marks_in(with({{"kind", "walker"}})).all[0].label == "walker");
    CHECK(marks_in(with({{"score", 87}})).all[0].label.empty());
}

TEST_CASE("marks: a label is at most 48 characters of printable ASCII")
{
    CHECK(marks_in(with({{"class", "Zoë\n"}})).all[0].label == "Zo???");
    CHECK(marks_in(with({{"class", std::string(10'000, 'x')}})).all[0].label.size() == 48);
}

TEST_CASE("marks: arrays of points are shapes, in both ways of writing them; others are ignored")
{
    const auto mark = marks_in(with({{"trail", {{1, 2}, {3, 4}}},
                                     {"hull", {{{"x", 1}, {"y", 2}}, {{"x", 3}, {"y", 4}}, {{"x", 5}, {"y", 6}}}},
                                     {"fingers", {{7, 8}}},
                                     {"numbers", {1, 2}},
                                     {"mixed", {{1, 2}, "x"}},
                                     {"none", json::array()}}))
                          .all.at(0);
    REQUIRE(mark.shapes.size() == 3);  // in the order of their names
    CHECK(mark.shapes[0].form == Shape::Form::dots);
    CHECK(mark.shapes[0].points == std::vector<cv::Point2d>{{7, 8}});
    CHECK(mark.shapes[1].form == Shape::Form::outline);
    CHECK(mark.shapes[1].points.size() == 3);
    CHECK(mark.shapes[2].form == Shape::Form::line);
    CHECK(mark.shapes[2].points == std::vector<cv::Point2d>{{1, 2}, {3, 4}});
}

TEST_CASE("marks: the masks, oriented boxes and keypoints of detect are areas, outlines and dots")
{
    const json square{{1, 2}, {3, 2}, {3, 4}, {1, 4}};
    const auto mark =
        marks_in(with({{"corners", square}, {"keypoints", {{5, 6, 0.9}, {0, 0, 0.1}}}, {"mask", square}})).all.at(0);
    REQUIRE(mark.shapes.size() == 3);
    CHECK(mark.shapes[0].form == Shape::Form::outline);
    CHECK_FALSE(mark.framed);  // the corners are its frame
    CHECK(mark.shapes[1].form == Shape::Form::dots);
    CHECK(mark.shapes[1].points == std::vector<cv::Point2d>{{5, 6}});  // the other one is not seen
    CHECK(mark.shapes[2].form == Shape::Form::area);
    CHECK(marks_in(with({{"mask", square}})).all.at(0).framed);
}

TEST_CASE("marks: objects without a valid box are ignored")
{
    for (const json& value :
         {json(nullptr), json(1), json("x"), json::array(), json{{"x", 1}, {"y", 2}, {"w", 3}},
          json{{"x", "1"}, {"y", 2}, {"w", 3}, {"h", 4}}, json{{"x", 1e300}, {"y", 2}, {"w", 3}, {"h", 4}},
          json{{"x", 1}, {"y", 2}, {"w", true}, {"h", 4}}})
        CHECK(marks_in({{"things", json::array({value})}, {"thing", value}}).all.empty());
    CHECK(marks_in(json::array({box})).all.empty());
    CHECK(marks_in({{"width", -1}, {"height", 480}}).seen.empty());
}

TEST_CASE("marks: tracks that are missing or not confirmed are uncertain")
{
    CHECK(marks_in(with({{"missing", 2}})).all.at(0).uncertain);
    CHECK(marks_in(with({{"confirmed", false}})).all.at(0).uncertain);
    CHECK_FALSE(marks_in(with({{"missing", 0}, {"confirmed", true}})).all.at(0).uncertain);
    CHECK_FALSE(marks_in(with(json::object())).all.at(0).uncertain);
}

TEST_CASE("marks: zones and lines are regions with their counts; other values are left out")
{
    const json corners{{0, 0}, {0.5, 0}, {0.5, 1}};
    const auto marks = marks_in({{"zones", {{{"name", "door"}, {"points", corners}, {"occupancy", 2}}}},
                                 {"lines", {{{"name", "till"}, {"points", {{0, 0}, {1, 1}}}, {"in", 3}, {"out", 1}}}}});
    REQUIRE(marks.regions.size() == 2);
    CHECK(marks.regions[0].label == "door 2");
    CHECK(marks.regions[0].closed);
    CHECK(marks.regions[1].label == "till in 3 out 1");
    CHECK_FALSE(marks.regions[1].closed);
    for (const json& points :
         {json(3), json::array(), json{{0, 0}, {1, 1}}, json{{0, 0}, {320, 0}, {1, 1}}, json{1, 2, 3}})
        CHECK(marks_in({{"zones", {{{"name", "a"}, {"points", points}}, 7}}, {"lines", "x"}}).regions.empty());
}

TEST_CASE("marks: the example on the drone's page is read as described there")
{
    const auto marks = marks_in(example().at("marks"));
    REQUIRE(marks.all.size() == 1);
    CHECK(marks.all[0].label == "face #7 12 px/s");
    CHECK(marks.all[0].shapes.size() == 1);
    CHECK(marks.seen == cv::Size2d(640, 480));
}
