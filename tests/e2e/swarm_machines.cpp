// Whole swarms over several machines reachable over ssh: network namespaces, each with its own sshd. Needs root,
// iproute2 and openssh-server; otherwise the tests are skipped.
#include "swarm_lab.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <algorithm>
#include <random>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// A source on one machine and workers on two others, which share it.
Json shared_work(int workers)
{
    return {
        {"swarm", "work"},
        {"drones",
         {{"source", {{"kind", "ticker"}, {"on", "cam1"}, {"set", {{"fps", 50}}}}},
          {"worker", {{"kind", "sleeper"}, {"count", workers}, {"on", {"gpu1", "gpu2"}}, {"set", {{"work_ms", 1}}}}}}},
        {"connections", {{{"from", "source"}, {"to", "worker-*"}, {"share", true}}}}};
}

}  // namespace

TEST_CASE("up over ssh: three machines in a few seconds, again nothing to do, a changed value is one set")
{
    if (!possible(missing_for_lab()))
        return;
    auto content = shared_work(4);
    const Machines machines(content);
    const auto begin = Clock::now();
    CHECK(lines_of(machines.up()) == 5 + 4);
    const auto took = Clock::now() - begin;
    MESSAGE("up took " << std::chrono::duration_cast<Milliseconds>(took).count() << " ms");
    CHECK(took < patient(15'000ms));
    const auto pids = machines.pids();
    CHECK(pids.size() == 5);
    const auto again = Clock::now();
    CHECK(machines.up().empty());
    MESSAGE("up again took " << std::chrono::duration_cast<Milliseconds>(Clock::now() - again).count() << " ms");
    CHECK(lines_of(machines.lab.hivectl_done("results 'worker-*' -n 8")) == 8);
    CHECK(Json::parse(machines.lab.machine(0).swarm.hivectl_done({"ps", "--json"})).size() == 1);
    CHECK(Json::parse(machines.lab.machine(1).swarm.hivectl_done({"ps", "--json"})).size() == 2);
    content["drones"]["source"]["set"]["fps"] = 40;
    machines.write(content);
    CHECK(machines.up() == "set source fps=40\n");
    CHECK(machines.pids() == pids);
    content["drones"]["source"]["log_level"] = "debug";
    content["drones"]["worker"]["on"] = "gpu1";
    machines.write(content);
    CHECK_EQ(machines.up(), "restart source log_level=debug\nrestart worker-2 on=gpu1\nrestart worker-4 on=gpu1\n");
    CHECK(machines.up().empty());
    CHECK(Json::parse(machines.lab.machine(1).swarm.hivectl_done({"ps", "--json"})).size() == 4);
    CHECK(lines_of(machines.lab.hivectl_done("results 'worker-*' -n 8")) == 8);
    machines.lab.hivectl_done("down");
    CHECK(eventually([&] { return machines.processes() == 0; }));
}

TEST_CASE("up over ssh: killed at any moment, the next one finds what was begun there, and no drone is there twice")
{
    if (!possible(missing_for_lab()))
        return;
    const Machines machines(shared_work(4));
    const auto seed = number_from("HIVE_TEST_SEED", static_cast<int>(std::random_device{}() / 2));
    INFO("HIVE_TEST_SEED=" << seed);
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const int rounds = number_from("HIVE_TEST_ROUNDS", sanitized() ? 2 : 6);
    const auto took = machines.lab.shell("hivectl up ~/work.json").took.count();
    machines.lab.hivectl_done("down");
    for (int round = 0; round < rounds; ++round) {
        {
            auto up = machines.lab.hivectl_running("up ~/work.json", "up");
            std::this_thread::sleep_for(std::chrono::microseconds(random() % static_cast<std::uint64_t>(took)));
            up.kill();
        }
        const auto next = machines.lab.shell("hivectl up ~/work.json");
        REQUIRE_MESSAGE(next.exit_code == 0, next.err);
        CHECK(machines.up().empty());
        CHECK(machines.pids().size() == 5);
        CHECK(eventually([&] { return machines.processes() == 5; }));
        machines.lab.hivectl_done("down");
        CHECK(eventually([&] { return machines.processes() == 0; }));
    }
}

TEST_CASE("up over ssh: what one machine lacks is said with its name, and nothing is left on the others")
{
    if (!possible(missing_for_lab()))
        return;
    auto content = shared_work(4);
    content["drones"]["zlast"] = {{"kind", "nowhere"}, {"on", "gpu2"}};
    const Machines machines(content);
    const auto refused = machines.lab.shell("hivectl up ~/work.json");
    CHECK(refused.exit_code == 5);
    CHECK_MESSAGE(has(refused.err, "gpu2: there is no drone hive-nowhere"), refused.err);
    CHECK(eventually([&] { return machines.processes() == 0; }));
    content["drones"].erase("zlast");
    content["drones"]["more"] = {{"kind", "sleeper"}, {"on", "gpu3"}};
    content["engines"] = {{"gpu3", {{"ssh", "127.0.0.9"}}}};  // no listener there
    machines.write(content);
    const auto unknown = machines.lab.shell("hivectl up ~/work.json");
    CHECK(unknown.exit_code == 5);
    CHECK_MESSAGE(has(unknown.err, "ssh does not reach 127.0.0.9"), unknown.err);
    CHECK(eventually([&] { return machines.processes() == 0; }));
}
