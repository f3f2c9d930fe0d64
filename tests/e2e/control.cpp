// Parameters and control by hand: fast, confirmed, all or nothing, and answered while user code is busy.
#include "measure.hpp"

#include <doctest/doctest.h>

#include <thread>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

std::string number(int value) { return std::to_string(value); }

std::vector<Process> eight_sleepers(const Swarm& swarm)
{
    std::vector<Process> drones;
    for (int i = 1; i <= 8; ++i)
        drones.push_back(swarm.drone("sleeper", "face-" + number(i)));
    return drones;
}

void put_one(hive::Application& application, const std::string& drone)
{
    application.put({drone, "image"}, Json::object(), hive::Body(std::string("x")), "text/plain");
}

/// The allowed time for a whole command with the promised bound: on a slow machine a multiple of a command that does
/// nothing.
double allowed_ms(const Swarm& swarm, double bound, double times)
{
    const double nothing = median_ms(swarm, {"--version"}, 15);
    MESSAGE("hivectl --version, median of 15: ", nothing, " ms");
    return std::max(bound, times * nothing);
}

std::string state_of(hive::Application& application, const std::string& drone)
{
    return std::string(token(application.status(drone).state));
}

}  // namespace

TEST_CASE("set: a whole command on an idle local drone takes less than 30 ms")
{
    const Swarm swarm;
    const auto drone = swarm.drone("sleeper", "face");
    CHECK(swarm.hivectl_done({"set", "face", "work_ms=7"}) == "7\n");
    CHECK(swarm.hivectl_done({"get", "face", "work_ms"}) == "7\n");
    const auto took = median_ms(swarm, {"set", "face", "work_ms=8"}, 15);
    MESSAGE("hivectl set, whole command, median of 15: ", took, " ms");
    if (!sanitized())
        CHECK(took < allowed_ms(swarm, 30, 4));
}

TEST_CASE("set: eight drones by a glob take less than 60 ms")
{
    const Swarm swarm;
    const auto drones = eight_sleepers(swarm);
    const auto took = median_ms(swarm, {"set", "face-*", "work_ms=8"}, 15);
    MESSAGE("hivectl set 'face-*' on 8 drones, whole command, median of 15: ", took, " ms");
    if (!sanitized())
        CHECK(took < allowed_ms(swarm, 60, 8));
    for (const auto& answer : swarm.application().get(swarm.application().find("face-*"), {"work_ms"}))
        CHECK(value_or_throw(answer.result) == Json{{"work_ms", 8}});
}

TEST_CASE("set: when one of eight refuses, by its declaration or by its own code, none has changed")
{
    const Swarm swarm;
    const auto drones = eight_sleepers(swarm);
    swarm.hivectl_done({"set", "face-*", "work_ms=8"});
    swarm.hivectl_done({"set", "face-5", "most_ms=50"});
    std::vector<std::string> command;
    SUBCASE("one drone's own code") { command = {"set", "face-*", "work_ms=60"}; }
    SUBCASE("out of range") { command = {"set", "face-*", "work_ms=-1"}; }
    SUBCASE("the second of two parameters") { command = {"set", "face-*", "work_ms=9", "throw_at=-1"}; }
    const auto refused = swarm.hivectl(command);
    CHECK(refused.exit_code == 5);
    CHECK(refused.out.empty());
    CHECK(refused.err.find("no drone was changed") != std::string::npos);
    auto application = swarm.application();
    const auto answers = application.get(application.find("face-*"), {"work_ms", "throw_at"});
    REQUIRE(answers.size() == 8);
    for (const auto& answer : answers) {
        CAPTURE(answer.drone);
        CHECK(value_or_throw(answer.result) == Json{{"work_ms", 8}, {"throw_at", 0}});
    }
}

TEST_CASE("busy: get, describe and ps answer in less than 50 ms while user code is inside a callback of 10 s, and stop "
          "ends it within 5 s")
{
    const Swarm swarm;
    auto drone = swarm.drone("sleeper", "face", {"work_ms=10000"});
    const double allowed = allowed_ms(swarm, 50, 5);
    auto application = swarm.application();
    put_one(application, "face");
    REQUIRE(eventually([&] { return state_of(application, "face") == "busy"; }));
    for (const auto& words : {std::vector<std::string>{"get", "face", "work_ms"}, {"describe", "face"}, {"ps"}}) {
        const auto took = median_ms(swarm, words, 9);
        MESSAGE("hivectl ", words[0], " of a busy drone, whole command, median of 9: ", took, " ms");
        if (!sanitized())
            CHECK(took < allowed);
    }
    REQUIRE(state_of(application, "face") == "busy");
    const auto stop = swarm.hivectl({"stop", "face"});
    CHECK(stop.exit_code == 0);
    CHECK(stop.took < stated(5000ms));
    CHECK(drone.wait(patient(2000ms)).has_value());
}

TEST_CASE("busy: a set that timed out exits with 124 and is not applied later")
{
    const Swarm swarm;
    const auto drone = swarm.drone("sleeper", "face", {"work_ms=2500"});
    auto application = swarm.application();
    put_one(application, "face");
    REQUIRE(eventually([&] { return state_of(application, "face") == "busy"; }));
    const auto late = swarm.hivectl({"set", "face", "work_ms=1", "--timeout", "1"});
    CHECK(late.exit_code == 124);
    CHECK(late.took >= 900ms);
    REQUIRE(eventually([&] { return state_of(application, "face") == "idle"; }));
    // A set now has overtaken nothing: the late one was before it in the queue.
    CHECK(application.set("face", {{"most_ms", 5000}}) == Json{{"most_ms", 5000}});
    CHECK(application.get("face", {"work_ms"}) == Json{{"work_ms", 2500}});
}
