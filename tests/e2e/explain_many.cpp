// hivectl explain of 64 drones on four machines: how long it takes. Needs what lab.hpp needs.
#include "swarm_lab.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <algorithm>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

TEST_CASE("explain: of 64 drones on four machines, the one that has halted is named within a second")
{
    if (!possible(missing_for_lab()))
        return;
    const Machines machines(
        {{"swarm", "many"},
         {"drones",
          {{"source", {{"kind", "ticker"}, {"on", "cam1"}, {"count", 16}, {"set", {{"fps", 2}}}}},
           {"worker", {{"kind", "sleeper"}, {"on", {"gpu1", "gpu2", "gpu3"}}, {"count", 48}}}}},
         {"connections",
          {{{"from", "source-1"}, {"to", "worker-*"}}, {{"from", "source-2"}, {"to", "worker-*"}, {"share", true}}}}},
        {"cam1", "gpu1", "gpu2", "gpu3"});
    CHECK(lines_of(machines.up()) > 64);
    CHECK(machines.pids().size() == 64);
    machines.lab.hivectl_done("halt worker-48");
    std::vector<std::chrono::microseconds> times;
    for (int i = 0; i < 10; ++i) {
        const auto found =
            machines.lab.shell(i % 2 == 0 ? "hivectl explain worker-48 --json" : "hivectl explain --json");
        CHECK(found.exit_code == 9);
        CHECK_MESSAGE(Json::parse(found.out).at("causes").at(0).at("what") == "halted", found.out);
        times.push_back(found.took);
    }
    std::ranges::sort(times);
    MESSAGE("from ", times.front().count() / 1000, " to ", times.back().count() / 1000, " ms");
    CHECK(times[times.size() / 2] < 1000ms);  // all 64 drones share the processors of this machine
    machines.lab.hivectl_done("down");
}
