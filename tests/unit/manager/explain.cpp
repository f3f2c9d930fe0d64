// What the walk finds in statuses that are hard to make for real: far machines, and drones that this machine does not
// know.
#include "explain/search.hpp"

#include <doctest/doctest.h>

using namespace hive;
using explaining::Absent;
using explaining::Look;
using explaining::Search;

namespace {

constexpr std::int64_t begin_us = 1'000'000'000'000'000, second_us = 1'000'000;
constexpr std::int64_t registration = 7;

/// A live source that has just sent, and a receiver far away.
Look far(std::int64_t skipped, int window = 1)
{
    EdgeStatus edge{.receiver = "face.image", .connected = true, .registration = registration};
    edge.options.window = window;
    edge.events.came(1000);
    edge.events.went(Fate::skipped, skipped);
    Status camera{.name = "camera", .kind = "camera", .epoch = begin_us, .state = State::idle};
    camera.uptime_us = 60 * second_us;
    camera.outputs.push_back({.name = "image",
                              .type = {},
                              .produced = 1000,
                              .last_emitted_us = begin_us + 60 * second_us,
                              .edges = {edge},
                              .why = Reason::not_asked});
    Status face{.name = "face", .kind = "face", .epoch = begin_us, .state = State::idle};
    face.uptime_us = 60 * second_us;
    face.inputs.push_back({.input = "image",
                           .from = "camera.image",
                           .connected = true,
                           .registration = registration,
                           .processed = 500,
                           .round_trip_us = 100'000});
    const Place there{.drone = "face", .host = "gpu1", .address = "tcp://gpu1:7700"};
    return {{{.drone = "camera", .status = camera, .error = {}},
             {.drone = "face", .status = face, .error = {}, .place = there}}};
}

std::vector<Cause> causes(const Look& look, const Look* earlier = nullptr, const std::string& drone = "face")
{
    const Absent absent;
    Search search(look, earlier, absent, "app-1");
    search.target(drone, "");
    return search.causes();
}

}  // namespace

TEST_CASE("explain: one request at a time over a long round trip is a cause as long as events are skipped")
{
    const auto before = far(10), after = far(20);
    const auto found = causes(after, &before);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == Cause::What::small_window);
    CHECK_FALSE(found[0].blocks);
    CHECK(found[0].text == "camera.image -> face.image: a window of 1 lets at most 10 events per second through");
    CHECK(found[0].command == "hivectl connect camera.image face.image --window 7");
    CHECK(causes(after, &after).empty());
    CHECK(causes(far(20, 7), nullptr).empty());
}

TEST_CASE("explain: a sender that this machine does not know is no cause for a receiver that is connected to it")
{
    auto look = far(0);
    look.answers[0].error = Error(Errc::not_found, "camera is not running");
    CHECK(causes(look).empty());
    look.answers[0].error = Error(Errc::invalid_argument, "several are called camera");
    CHECK(causes(look).empty());
    auto& input = look.answers[1].status.inputs[0];
    look.answers[0].error = Error(Errc::not_found, "camera is not running");
    input.connected = false;
    input.why = Reason::dialing;
    input.error = "no route to cam1";
    const auto found = causes(look);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == Cause::What::dialing);
    CHECK(found[0].text == "face.image is not connected to camera.image: no route to cam1");
    look.answers[1].place.host = Place::here;
    CHECK(causes(look).at(0).what == Cause::What::not_running);
}

TEST_CASE("explain: a connection that takes events slowly is a cause only if the sender has to wait for it")
{
    auto look = far(0);
    auto& output = look.answers[0].status.outputs[0];
    output.why = output.edges[0].why = Reason::lane_full;
    CHECK(causes(look).empty());
    output.last_emitted_us -= 2 * second_us;
    const auto found = causes(look);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == Cause::What::slow_connection);
    CHECK(found[0].connection == "camera.image -> face.image");
    CHECK(found[0].evidence.find("nothing for 2.0 s") != std::string::npos);
}

TEST_CASE("explain: a cycle of connections, and a receiver that is asked for twice, end the walk")
{
    auto look = far(0);
    auto& camera = look.answers[0].status;
    camera.inputs.push_back({.input = "control", .from = "face.faces", .connected = true});
    CHECK(causes(look).empty());
    camera.state = State::halted;
    CHECK(causes(look).size() == 1);
    CHECK(causes(look, nullptr, "camera").size() == 1);
}
