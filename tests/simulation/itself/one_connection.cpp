// An operator connects two drones while the restarted receiver reconnects by itself: afterwards there is one
// connection, known to both ends.
#include "../drones.hpp"
#include "world.hpp"

#include <simulation.hpp>

#include <hive/application.hpp>
#include <hive/embedded_drone.hpp>

#include <doctest/doctest.h>
#include <eventually.hpp>

using namespace hive;
using namespace std::chrono_literals;
using simulation::World;

namespace {

void run_drone(const EmbeddedOptions& options, void (*make)(Drone&), Drone*& self)
{
    EmbeddedDrone embedded({options.name, "of a test"}, options);
    make(embedded.drone());
    embedded.drone().on_start([&] { self = &embedded.drone(); });
    embedded.run();
}

const std::string place = "tcp://127.0.0.1:7701";

/// Does the receiver get events some time after it was connected?
/// @param at  the address at which it tries to reconnect
bool received_in(std::uint64_t seed, const std::string& at)
{
    simulation::enter_empty_home();
    Drone *sender = nullptr, *receiver = nullptr;
    bool connected = false;
    World world(seed);
    world.spawn("receiver", [&] {
        run_drone({.name = "receiver", .connect = {"image=sender.tick,share" + at}}, simulation::worker, receiver);
    });
    world.spawn("sender", [&] {
        world.sleep(world.between(0ms, 500ms));
        run_drone({.name = "sender", .listen = {place}, .insecure = true, .parameters = {{"count", 1'000'000}}},
                  simulation::source, sender);
    });
    world.spawn("operator", [&] {
        while (!sender || !receiver)
            world.sleep(1ms);
        world.sleep(world.between(0ms, 300ms));
        Application::Options options;
        options.name = "operator";
        Application application(options);
        application.connect({"sender", "tick"}, {"receiver", "image"}, {.group = "workers", .lease = {}});
        connected = true;
    });
    const auto run = [&](std::chrono::milliseconds time) {
        for (const auto limit = world.now() + time; world.step(limit);) {
        }
    };
    run(3s);
    CHECK(connected);
    const auto inputs = receiver->status().inputs;
    CHECK(inputs.size() == 1);
    const auto before = inputs.at(0).received;
    run(1s);
    return receiver->status().inputs.at(0).received > before + 10;
}

}  // namespace

TEST_CASE("a connection that comes back by itself takes nothing from one that is being made in its place")
{
    for (std::uint64_t seed = 1; seed <= (hive::test::sanitized() ? 100 : 1000); ++seed) {
        CHECK_MESSAGE(received_in(seed, ""), "seed " << seed << ", both over one connection");
        CHECK_MESSAGE(received_in(seed, ",at=" + place), "seed " << seed << ", over two");
    }
}
