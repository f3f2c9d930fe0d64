// Swarms of many drones: over four machines, and by a hivectl with fewer descriptors than drones. HIVE_TEST_DRONES=1000
// has as many as a swarm can have; the figures of one machine are from scripts/measure-many.
#include "swarm_lab.hpp"

#include <mute_server.hpp>

#include <hive/event/module.hpp>

#include <doctest/doctest.h>
#include <possible.hpp>

#include <algorithm>
#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;
using hive::event::LinkPtr;
using hive::protocol::PacketType;

namespace {

/// A ticker on each machine, and sleepers of all machines that share the work of one of them.
Json many(int drones)
{
    const Json machines{"cam1", "m2", "m3", "m4"};
    Json content{{"swarm", "many"}, {"drones", Json::object()}, {"connections", Json::array()}};
    for (int i = 0; i < 4; ++i) {
        const auto number = std::to_string(i + 1), ticker = "tick" + number, workers = "work" + number;
        content["drones"][ticker] = {{"kind", "ticker"}, {"on", machines[i]}, {"set", {{"fps", 1}, {"bytes", 100}}}};
        content["drones"][workers] = {{"kind", "sleeper"}, {"count", drones / 4 - 1}, {"on", machines}};
        content["connections"].push_back({{"from", ticker}, {"to", workers + "-*"}, {"share", true}});
    }
    return content;
}

/// The output of a command on the laptop with the default limit of descriptors. Prints its duration.
std::string timed(const Machines& machines, const std::string& words)
{
    const auto begin = Clock::now();
    auto done = machines.lab.shell("ulimit -n 1024; hivectl " + words, 300'000ms);
    const Seconds took = Clock::now() - begin;
    MESSAGE(words << ": " << took.count() << " s (load " << machine_load() << ")");
    REQUIRE_MESSAGE(done.exit_code == 0, words << ": " << done.err.substr(0, 1000));
    return std::move(done.out);
}

/// An application that keeps at most two idle connections, and dials two at once.
class Frugal {
public:
    Frugal(const Swarm& swarm)
        : home_(swarm.home()),
          module_({.self = {.name = "frugal", .kind = "application", .epoch = 1, .pid = 1},
                   .limits = {},
                   .timing = {},
                   .most_dialed = 2,
                   .most_dialing = 2})
    {
        module_.start();
    }
    LinkPtr link_to(const std::string& drone)
    {
        std::optional<LinkPtr> found;
        module_.call([&] {
            module_.with_link(home_.address(drone), hive::event::Clock::now() + patient(5000ms),
                              [&](const hive::Result<LinkPtr>& link) { found = value_or_none(link); });
        });
        module_.loop().wait(hive::event::Clock::time_point::max(), [&] { return found.has_value(); });
        return *found;
    }
    /// Runs until a peer sends hello, at most as long as a test.
    void begin_to_dial(const std::string& address, bool& over)
    {
        module_.call([&] {
            module_.with_link(hive::transport::parse_address(address), hive::event::Clock::now() + patient(20'000ms),
                              [&over](const hive::Result<LinkPtr>&) { over = true; });
        });
    }
    std::ptrdiff_t open(const std::vector<LinkPtr>& links)
    {
        std::ptrdiff_t count = 0;
        module_.call([&] { count = std::ranges::count_if(links, [](const LinkPtr& link) { return link->open(); }); });
        return count;
    }
    void hold(const LinkPtr& link, bool held)
    {
        module_.call([&] { link->held = held; });
    }

private:
    hive::event::Home home_;
    hive::event::Module module_;
};

}  // namespace

TEST_CASE("many: connections with nothing to do are let go for others, but for those that somebody holds")
{
    const Swarm swarm;
    const std::vector<std::string> names{"one", "two", "three", "four"};
    std::vector<Process> drones;
    for (const auto& name : names)
        drones.push_back(swarm.drone("sleeper", name));
    Frugal frugal(swarm);
    for (const bool held : {false, true}) {
        std::vector<LinkPtr> links;
        for (const auto& name : names) {
            REQUIRE(links.emplace_back(frugal.link_to(name)));
            frugal.hold(links.back(), held);
        }
        CHECK(eventually([&] { return frugal.open(links) == (held ? 4 : 2); }));
        for (const auto& link : links)
            frugal.hold(link, false);
    }
}

TEST_CASE("many: drones that do not answer do not keep others from being dialed")
{
    const Swarm swarm;
    const auto drone = swarm.drone("sleeper", "one");
    const MuteServer nobody;
    bool over = false;
    Frugal frugal(swarm);
    for (const std::string host : {"127.0.0.1", "127.0.0.2", "127.0.0.3"})
        frugal.begin_to_dial("tcp://" + host + ":" + nobody.port(), over);
    CHECK(frugal.link_to("one"));
    CHECK_FALSE(over);
}

TEST_CASE("many: on one machine there may be more drones than hivectl may have descriptors")
{
    const Swarm swarm;
    const Json content{{"swarm", "many"}, {"drones", {{"work", {{"kind", "sleeper"}, {"count", 140}}}}}};
    std::ofstream(swarm.home() / "many.json") << content;
    const auto with_few = [&](const std::string& words) {
        return swarm.run({"/bin/sh", "-c", "ulimit -n 128; cd $HIVE_HOME; exec hivectl " + words}, 60'000ms);
    };
    const auto up = with_few("up many.json");
    REQUIRE_MESSAGE(up.exit_code == 0, up.err.substr(0, 1000));
    CHECK(std::ranges::count(up.out, '\n') == 140);
    CHECK(Json::parse(with_few("ps --json").out).size() == 140);
    CHECK(std::ranges::count(with_few("down").out, '\n') == 140);
}

TEST_CASE("many: over four machines with 1,024 descriptors, up, again nothing to do, a set to all, and down")
{
    if (!possible(missing_for_lab()))
        return;
    const int drones = number_from("HIVE_TEST_DRONES", 60) / 4 * 4;
    const Machines machines(many(drones), {"cam1", "m2", "m3", "m4"});
    const auto up = timed(machines, "up ~/work.json --timeout 200");
    CHECK(std::ranges::count(up, '\n') == drones + drones - 4);
    CHECK(timed(machines, "up ~/work.json").empty());
    CHECK(Json::parse(timed(machines, "ps --json --timeout 20")).size() == static_cast<std::size_t>(drones));
    CHECK(std::ranges::count(timed(machines, "set 'work*' work_ms=2 --timeout 60"), '\n') == drones - 4);
    const auto edges = Json::parse(timed(machines, "edges --json --timeout 20"));
    CHECK(std::ranges::count_if(edges, [](const Json& row) { return row.value("known_by", "") == "both"; })
          == drones - 4);
    timed(machines, "audit");
    timed(machines, "explain");
    timed(machines, "export");
    CHECK(std::ranges::count(timed(machines, "down"), '\n') == drones);
    CHECK(eventually([&] { return machines.processes() == 0; }));
}
