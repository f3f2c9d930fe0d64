// A drone is frozen for longer than its peer's inactivity timeout, and then continues.
#include "../drones.hpp"
#include "world.hpp"

#include <simulation.hpp>

#include <hive/application.hpp>
#include <hive/embedded_drone.hpp>
#include <hive/event/home.hpp>
#include <hive/event/module.hpp>
#include <hive/protocol/requests.hpp>

#include <doctest/doctest.h>

#include <numeric>

using namespace hive;
using namespace std::chrono_literals;
using simulation::World;

namespace {

constexpr int all = 300;

/// The events that an application on another machine receives from it.
std::vector<std::int64_t> collected_in(std::uint64_t seed)
{
    simulation::enter_empty_home();
    World world(seed);
    std::vector<std::int64_t> collected;
    auto& drone = world.spawn("source", [] {
        EmbeddedDrone embedded({"source", "of a test"},
                               {.name = "source", .parameters = {{"pace", "demand"}, {"count", all}}});
        simulation::source(embedded.drone());
        embedded.run();
    });
    world
        .spawn("elsewhere",
               [&] {
                   world.sleep(100ms);
                   Application::Options options;
                   options.name = "elsewhere";
                   Application application(options);
                   const auto collector = application.collect({{"source", "tick"}}, {.connection = {.window = 8}});
                   for (;;)
                       if (const auto event = collector->next(1s)) {
                           collected.push_back(event->identity.sequence);
                           world.sleep(world.between(0ms, 5ms));
                       }
               })
        .machine = 1;
    const auto run = [&](simulation::Duration time) {
        for (const auto limit = world.now() + time; world.step(limit);) {
        }
    };
    run(100ms + world.between(0ms, 700ms));
    drone.frozen = true;
    run(world.between(2s, 4s));
    drone.frozen = false;
    run(10s);
    return collected;
}

/// Does a receiver that is asked to connect within that time do so, though the sender is frozen at first?
bool connected_in(std::chrono::milliseconds timeout, simulation::Duration frozen)
{
    simulation::enter_empty_home();
    World world(1);
    const auto spawn = [&](const std::string& name, void (*make)(Drone&)) -> simulation::Process& {
        return world.spawn(name, [name, make] {
            EmbeddedDrone embedded({name, "of a test"}, {.name = name});
            make(embedded.drone());
            embedded.run();
        });
    };
    auto& sender = spawn("sender", simulation::source);
    spawn("receiver", simulation::worker);
    bool connected = false;
    const auto run = [&](simulation::Duration time) {
        for (const auto limit = world.now() + time; world.step(limit);) {
        }
    };
    run(100ms);
    sender.frozen = true;
    world.spawn("operator", [&] {
        event::Module module({.self = {.name = "operator", .kind = "application"}, .limits = {}, .timing = {}});
        module.start();
        auto asked = to_json(protocol::Connect{.drone = "sender", .output = "tick", .input = "image", .options = {}});
        asked["deadline_ms"] = timeout.count();
        std::optional<event::Outcome> answer;
        module.call([&] {
            module.request(event::Home(default_home()).address("receiver"), protocol::PacketType::connect, asked, {},
                           event::Clock::now() + timeout, [&](const event::Outcome& outcome) { answer = outcome; });
        });
        module.loop().wait(event::Clock::time_point::max(), [&] { return answer.has_value(); });
        connected = std::holds_alternative<Json>(*answer);
    });
    run(frozen);
    sender.frozen = false;
    run(4s);
    return connected;
}

}  // namespace

TEST_CASE("frozen: a connect to a drone that does not answer at first is tried again while there is time")
{
    CHECK(connected_in(20s, 4s));
    CHECK(connected_in(20s, 14s));
    CHECK_FALSE(connected_in(5s, 4s));
}

TEST_CASE("frozen: a drone that was taken for dead does not take who cut it off for dead, and loses nothing")
{
    std::vector<std::int64_t> numbers(all);
    std::iota(numbers.begin(), numbers.end(), 1);
    for (std::uint64_t seed = 1; seed <= 100; ++seed)
        CHECK_MESSAGE(collected_in(seed) == numbers, "seed " << seed);
}
