// Turns at preparing sets are shared out.
#include "set_turns.hpp"

#include <doctest/doctest.h>

namespace hive::service {
namespace {

using std::chrono::milliseconds;

struct Drone {
    bool prepare(const std::string& asker)
    {
        if (held) {
            turns.refused(asker);
            return false;
        }
        return held = turns.taken_by(asker, now).empty();
    }
    void decide(bool committed)
    {
        held = false;
        turns.freed(committed, now);
    }

    SetTurns turns;
    event::Clock::time_point now{std::chrono::hours(1)};
    bool held = false;
};

}  // namespace

TEST_CASE("set turns: who was refused first comes next, if it comes soon")
{
    Drone drone;
    REQUIRE(drone.prepare("storm"));
    CHECK_FALSE(drone.prepare("user"));
    CHECK_FALSE(drone.prepare("third"));
    drone.decide(false);
    CHECK_FALSE(drone.prepare("storm"));
    CHECK_FALSE(drone.prepare("third"));
    SUBCASE("it comes") { CHECK(drone.prepare("user")); }
    SUBCASE("it is gone")
    {
        drone.now += SetTurns::kept;
        CHECK(drone.prepare("storm"));
    }
}

TEST_CASE("set turns: who has waited may try again and again for a while, and others come next")
{
    Drone drone;
    REQUIRE(drone.prepare("storm"));
    CHECK_FALSE(drone.prepare("user"));
    drone.decide(false);
    for (int i = 0; i < 2; ++i) {
        REQUIRE(drone.prepare("user"));
        CHECK_FALSE(drone.prepare("storm"));
        drone.decide(false);
        CHECK_FALSE(drone.prepare("storm"));
    }
    SUBCASE("its while is over") { drone.now += SetTurns::lasting; }
    SUBCASE("its set was committed")
    {
        REQUIRE(drone.prepare("user"));
        drone.decide(true);
    }
    CHECK_FALSE(drone.prepare("user"));
    CHECK(drone.prepare("storm"));
}

TEST_CASE("set turns: without a contest nobody waits")
{
    Drone drone;
    for (const char* asker : {"one", "one", "other"}) {
        CHECK(drone.prepare(asker));
        drone.decide(false);
    }
}

}  // namespace hive::service
