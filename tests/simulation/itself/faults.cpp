// Writes after a crash point are invisible, silenced bytes arrive late, clocks differ, and a liar lies once.
#include "../drones.hpp"
#include "../lies.hpp"
#include "network.hpp"
#include "world.hpp"

#include <simulation.hpp>

#include <hive/embedded_drone.hpp>
#include <hive/platform/clock.hpp>
#include <hive/platform/files.hpp>

#include <doctest/doctest.h>

using namespace hive;
using namespace std::chrono_literals;
using simulation::World;

namespace {

void run(World& world, std::chrono::milliseconds time)
{
    for (const auto limit = world.now() + time; world.step(limit);) {
    }
}

/// The visible ones of three writes of a process that dies at the last but `left`.
std::vector<std::string> files_after(int left)
{
    simulation::enter_empty_home();
    World world(1);
    const std::filesystem::path home = "home";
    std::filesystem::create_directory(home);
    bool went_on = false;
    auto& process = world.spawn("writer", [&] {
        CHECK(platform::write_private(home / "one.new", "1"));
        CHECK(!platform::rename(home / "one.new", home / "one"));
        CHECK(platform::write_private(home / "two", "2"));
        world.sleep(1ms);
        went_on = true;
    });
    process.writes_left = left;
    run(world, 1s);
    CHECK(process.dead);
    CHECK(went_on == (left == 3));
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(home))
        names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
}

}  // namespace

TEST_CASE("crash point: nothing is seen of what a process does from the write on at which it dies")
{
    CHECK(files_after(0).empty());
    CHECK(files_after(1) == std::vector<std::string>{"one.new"});
    CHECK(files_after(2) == std::vector<std::string>{"one"});
    CHECK(files_after(3) == std::vector<std::string>{"one", "two"});
}

TEST_CASE("silence: no event arrives while one of two drones does not hear the other, and all go on afterwards")
{
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        simulation::enter_empty_home();
        World world(seed);
        Drone* receiver = nullptr;
        auto& sender = world.spawn("sender", [&] {
            EmbeddedDrone embedded({"sender", "of a test"}, {.name = "sender", .parameters = {{"count", 1'000'000}}});
            simulation::source(embedded.drone());
            embedded.run();
        });
        world.spawn("receiver", [&] {
            EmbeddedDrone embedded({"receiver", "of a test"}, {.name = "receiver", .connect = {"image=sender.tick"}});
            simulation::worker(embedded.drone());
            embedded.drone().on_start([&] { receiver = &embedded.drone(); });
            embedded.run();
        });
        const auto received = [&] { return receiver->status().inputs.at(0).received; };
        run(world, 2s);
        REQUIRE(received() > 10);
        const auto other = [](const simulation::Process&) { return true; };
        CHECK(simulation::silence_one_connection(sender, other, world.now() + 1s) == "receiver");
        run(world, 100ms);
        const auto before = received();
        run(world, 800ms);
        CHECK(received() == before);
        run(world, 1s);
        CHECK(received() > before + 10);
    }
}

TEST_CASE("clock step: a drone that comes back after a crash has a larger epoch, though the clock was set back")
{
    simulation::enter_empty_home();
    World world(1);
    Drone* drone = nullptr;
    const auto live = [&] {
        EmbeddedDrone embedded({"drone", "of a test"}, {.name = "drone"});
        simulation::source(embedded.drone());
        embedded.drone().on_start([&] { drone = &embedded.drone(); });
        embedded.run();
    };
    auto& first_run = world.spawn("drone", live);
    run(world, 1s);
    const auto epoch = drone->status().epoch;
    world.kill(first_run);
    world.set_time_of_day(-1h);
    world.spawn("drone", live);
    run(world, 1s);
    CHECK(drone->status().epoch > epoch);
}

TEST_CASE("clocks: each machine has its own, and from what it shows follows when that was")
{
    World world(1);
    world.set_clock(1, {.offset = -1h, .drift_ppm = 200});
    const auto shown = [&](int machine) {
        std::chrono::microseconds time{};
        world
            .spawn("clock",
                   [&] {
                       world.sleep(10s);
                       time = std::chrono::duration_cast<std::chrono::microseconds>(
                           platform::WallClock::now().time_since_epoch() - simulation::when_it_began);
                   })
            .machine = machine;
        run(world, 11s);
        const auto since = std::chrono::abs(world.age_at(machine, time) + 1s - world.age());
        CHECK(since < 1ms);
        return time;
    };
    const auto here = shown(0), there = shown(1) - 11s;
    CHECK(std::chrono::abs(there - here + 1h - 4ms) < 1ms);  // 200 ppm of 21 s
}

TEST_CASE("lie: in one packet of a process one field is a lie, and an honest peer goes on")
{
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        simulation::enter_empty_home();
        World world(seed);
        int lies = 0;
        auto& liar = world.spawn("liar", [&] {
            EmbeddedDrone embedded({"sender", "of a test"}, {.name = "liar", .parameters = {{"count", 1'000'000}}});
            simulation::source(embedded.drone());
            embedded.run();
        });
        simulation::let_lie(liar, static_cast<int>(seed % 6), [&](const std::string&) { ++lies; });
        auto& receiver = world.spawn("receiver", [&] {
            EmbeddedDrone embedded({"receiver", "of a test"}, {.name = "receiver", .connect = {"image=liar.tick"}});
            simulation::worker(embedded.drone());
            embedded.run();
        });
        run(world, 5s);
        CHECK(lies == 1);
        CHECK_FALSE(receiver.dead);
        CHECK_FALSE(liar.dead);
    }
}
