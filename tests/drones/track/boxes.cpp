// Reads boxes from headers of any drone, and refuses invalid ones.
#include "../../../drones/track/boxes.hpp"

#include <doctest/doctest.h>
#include <hive/error.hpp>

#include <optional>

using hive::Json;
using track::Box;
using track::boxes_in;

namespace {

std::optional<hive::Errc> refusal(const Json& header, const std::string& name = "")
{
    try {
        static_cast<void>(boxes_in(header, name));
        return std::nullopt;
    } catch (const hive::Error& error) {
        return error.code();
    }
}

}  // namespace

TEST_CASE("boxes: the only array of boxes is found, with any name and any other fields")
{
    const std::vector<Box> one{{1, 2, 3, 4}};
    CHECK(boxes_in(Json::parse(R"({"faces":[{"x":1,"y":2,"w":3,"h":4}],"width":640,"height":480})"), "") == one);
    const auto scored = boxes_in(
        Json::parse(R"({"objects":[{"x":1.0,"y":2,"w":3,"h":4,"class":"dog","score":0.5}],"labels":["dog"]})"), "");
    CHECK(scored == std::vector<Box>{{.x = 1, .y = 2, .w = 3, .h = 4, .score = 0.5}});
    CHECK(boxes_in(Json::parse(R"({"boxes":[],"width":640,"height":480,"learned":7})"), "").empty());
}

TEST_CASE("boxes: of several arrays the name chooses")
{
    const Json header = Json::parse(R"({"faces":[{"x":1,"y":2,"w":3,"h":4}],"people":[{"x":5,"y":6,"w":7,"h":8}]})");
    CHECK(refusal(header) == hive::Errc::malformed);
    CHECK(boxes_in(header, "people") == std::vector<Box>{{5, 6, 7, 8}});
    CHECK(refusal(header, "dogs") == hive::Errc::malformed);
}

TEST_CASE("boxes: invalid boxes are refused")
{
    for (const char* text :
         {R"({})", R"({"boxes":{}})", R"({"boxes":[1]})", R"({"boxes":[{"x":1,"y":2,"w":3}]})",
          R"({"boxes":[{"x":"1","y":2,"w":3,"h":4}]})", R"({"boxes":[{"x":1,"y":2,"w":0,"h":4}]})",
          R"({"boxes":[{"x":1,"y":2,"w":3,"h":-4}]})", R"({"boxes":[{"x":1e300,"y":2,"w":3,"h":4}]})"}) {
        CAPTURE(text);
        CHECK(refusal(Json::parse(text)) == hive::Errc::malformed);
    }
    const Json box{{"x", 1}, {"y", 2}, {"w", 3}, {"h", 4}};
    CHECK_FALSE(refusal({{"boxes", Json(track::max_boxes, box)}}));
    CHECK(refusal({{"boxes", Json(track::max_boxes + 1, box)}}) == hive::Errc::too_large);
}

TEST_CASE("boxes: a score and colours are taken, and left alone when they are something else")
{
    const auto read = [](const Json& more) {
        Json box{{"x", 1}, {"y", 2}, {"w", 3}, {"h", 4}};
        box.update(more);
        return boxes_in({{"boxes", Json::array({box})}}, "").at(0);
    };
    CHECK(read({{"score", 0.25}}).score == 0.25);
    CHECK(read({{"score", "high"}}).score > 1e9);
    CHECK(read({{"colours", {1, 3}}}).look == track::Look{0.25F, 0.75F});
    for (const Json& none : {Json("red"), Json::array(), Json{1, -1}, Json{1, "b"}, Json{0, 0}, Json(65, 1)})
        CHECK(read({{"colours", none}}).look.empty());
}

TEST_CASE("boxes: as many tracks as there may be fit into a header")
{
    track::Track one{.id = 1234567,
                     .box = {-1234.56, 1234.56, 1234.56, 1234.56},
                     .age = 12345,
                     .seconds = 12345.6789,
                     .speed_x = -1234.56,
                     .speed_y = 1234.56,
                     .hits = 12345,
                     .missing = 100,
                     .confirmed = false};
    const std::string text = hive::to_text({{"tracks", track::to_json(std::vector(track::max_boxes, one))}});
    CHECK(text.size() < 60 * 1024);
    CHECK(track::to_json({one})[0]
          == Json::parse(
              R"({"id":1234567,"x":-1234.6,"y":1234.6,"w":1234.6,"h":1234.6,"vx":-1234.6,"vy":1234.6,"speed":1745.9,
        "age":12345,"seconds":12345.679,"hits":12345,"missing":100,"confirmed":false})"));
}
