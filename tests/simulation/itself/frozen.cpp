// A drone is frozen for longer than its peer's inactivity timeout, and then continues.
#include "../drones.hpp"
#include "world.hpp"

#include <simulation.hpp>

#include <hive/application.hpp>
#include <hive/embedded_drone.hpp>

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

}  // namespace

TEST_CASE("frozen: a drone that was taken for dead does not take who cut it off for dead, and loses nothing")
{
    std::vector<std::int64_t> numbers(all);
    std::iota(numbers.begin(), numbers.end(), 1);
    for (std::uint64_t seed = 1; seed <= 100; ++seed)
        CHECK_MESSAGE(collected_in(seed) == numbers, "seed " << seed);
}
