// The zones drone behind a tracker, as processes: events, counts, and zones that are refused.
#include "swarm.hpp"

#include <doctest/doctest.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

TEST_CASE("zones swarm: walkers cross the middle, and events agree with the counts and the times of the capture")
{
    const Swarm swarm;
    const auto zones = swarm.drone(
        "zones", "zones", {"zones=left: 0,0 0.5,0 0.5,1 0,1; right: 0.5,0 1,0 1,1 0.5,1", "lines=middle: 0.5,1 0.5,0"});
    const auto track = swarm.drone("track", "track"), background = swarm.drone("background", "background");
    const auto camera =
        swarm.drone("camera", "camera", {"width=320", "height=240", "faces=0", "walkers=3", "pace=demand", "loop=off"});
    auto application = swarm.application();
    const auto events = application.collect({{"zones", "events"}}), counts = application.collect({{"zones", "counts"}});
    swarm.hivectl_done({"connect", "track", "zones"});
    swarm.hivectl_done({"connect", "background", "track"});
    swarm.hivectl_done({"connect", "camera", "background"});
    std::map<std::string, std::int64_t> seen;
    Json last;
    for (int frame = 0; frame < (sanitized() ? 60 : 300); ++frame) {
        const auto event = counts->next(patient(5000ms));
        REQUIRE(event);
        last = event->header;
        while (const auto one = events->next(0ms)) {
            ++seen[one->header.at("event")];
            if (one->header.value("lost", false) == false)
                CHECK(one->header.at("time_us") == one->identity.captured_us);
        }
    }
    CHECK(last.at("width") == 320);
    CHECK(last.at("width").is_number_integer());  // otherwise no table has the image size
    if (!sanitized()) {
        CHECK(seen["enter"] >= 3);
        CHECK(seen["cross"] >= 1);
        std::int64_t crossed = 0;
        for (const auto& line : last.at("lines"))
            crossed += line.at("in").get<std::int64_t>() + line.at("out").get<std::int64_t>();
        CHECK(crossed >= 1);
    }
}

TEST_CASE("zones swarm: a bad polygon is refused with the cause, and the old one stays")
{
    const Swarm swarm;
    const auto zones = swarm.drone("zones", "zones", {"zones=door: 0,0 1,0 1,1"});
    const auto refused = swarm.hivectl({"set", "zones", "zones=door: 0,0 640,0 1,1"});
    CHECK(refused.exit_code == 5);
    CHECK(refused.err.find("zones: door: \"640,0\" is outside 0 to 1") != std::string::npos);
    CHECK(swarm.hivectl_done({"get", "zones", "zones"}) == "door: 0,0 1,0 1,1\n");
}
