// Headers of other drones, read; and the examples on the page.
#include "../../../drones/zones/report.hpp"

#include <page.hpp>

#include <doctest/doctest.h>
#include <hive/error.hpp>

using namespace zones;
using hive::Json;

namespace {

const Json track{{"id", 4}, {"x", 100}, {"y", 100}, {"w", 40}, {"h", 100}, {"missing", 0}, {"confirmed", true}};

Json header(const Json& tracks) { return {{"tracks", tracks}, {"width", 400}, {"height", 400}}; }

std::string refusal(const Json& of, const std::string& name = "")
{
    try {
        static_cast<void>(read_frame(of, name, Anchor::foot));
        return "";
    } catch (const hive::Error& error) {
        return error.what();
    }
}

}  // namespace

TEST_CASE("observations: the foot is the middle of the lower side, the centre that of the box")
{
    CHECK(read_frame(header(Json::array({track})), "", Anchor::foot).observations.at(0).anchor == Point{0.3, 0.5});
    CHECK(read_frame(header(Json::array({track})), "", Anchor::centre).observations.at(0).anchor == Point{0.3, 0.375});
}

TEST_CASE("observations: tracks that are not confirmed are left out, missing ones are not seen, faces have no id")
{
    Json missing = track, young = track;
    missing["missing"] = 3;
    young["confirmed"] = false;
    const auto frame = read_frame(header(Json::array({track, missing, young})), "", Anchor::foot);
    REQUIRE(frame.observations.size() == 2);
    CHECK(frame.observations[0].seen);
    CHECK_FALSE(frame.observations[1].seen);
    CHECK(frame.boxes.size() == 2);
    const auto faces = read_frame({{"faces", {{{"x", 1}, {"y", 2}, {"w", 3}, {"h", 4}}}}, {"width", 9}, {"height", 9}},
                                  "", Anchor::foot);
    CHECK_FALSE(faces.observations.at(0).id);
}

TEST_CASE("observations: what cannot be placed is refused")
{
    CHECK(refusal({{"tracks", Json::array({track})}}).find("no width and height") != std::string::npos);
    CHECK(refusal({{"width", 9}, {"height", 9}}).find("no array of boxes") != std::string::npos);
    CHECK(refusal(header(Json::array({track})), "faces").find("named \"faces\"") != std::string::npos);
    CHECK(refusal(header(Json(257, track))).find("more than 256") != std::string::npos);
}

TEST_CASE("observations: the page shows exactly the fields of counts")
{
    Counter counter;
    counter.arrange(read_zones("left: 0,0 0.5,0 0.5,1 0,1"), read_lines("middle: 0.5,1 0.5,0"));
    const auto frame = read_frame(header(Json::array({track})), "", Anchor::foot);
    counter.next({1, 1}, 1, frame.observations);
    const auto written = counts_header(counter, frame, {2, 2});
    const auto shown = hive::test::json_example("zones");
    CHECK(hive::test::keys(shown) == hive::test::keys(written));
    for (const char* part : {"zones", "lines", "tracks"})
        CHECK(hive::test::keys(shown.at(part).at(0)) == hive::test::keys(written.at(part).at(0)));
    CHECK(written["zones"][0]["present"] == Json{{{"id", 4}, {"seconds", 1.0}}});
    CHECK(written["zones"][0]["occupancy"] == 1);
}

TEST_CASE("observations: an event has kind, place, id and time")
{
    CHECK(event_header({.kind = Occurrence::Kind::cross, .shape = "till", .id = 3, .at = {1.5, 9}, .right = true}, true)
          == Json::parse(
              R"({"event":"cross","line":"till","id":3,"time_us":9,"direction":"in","media_time_us":1500000})"));
    CHECK(
        event_header({.kind = Occurrence::Kind::leave, .shape = "door", .id = 3, .at = {1.5, 9}, .dwell = 0.25}, false)
        == Json::parse(R"({"event":"leave","zone":"door","id":3,"time_us":9,"seconds":0.25,"lost":false})"));
}
