// Drones that receive each other's results in a circle, and have all ended, are asked to confirm that: each asks the
// next one. The answer arrives in time, and then no more questions are sent.
#include "world.hpp"

#include <simulation.hpp>

#include <hive/application.hpp>
#include <hive/embedded_drone.hpp>

#include <doctest/doctest.h>

using namespace hive;
using namespace std::chrono_literals;
using simulation::World;

namespace {

/// Ends its output on request, or when all of its inputs have ended.
void member_of_ring(Drone& drone)
{
    const auto over = std::make_shared<std::pair<bool, bool>>();  // told to end, and has ended
    drone.parameter("over", over->first, {}, "");
    const auto result = drone.output("result", "application/json", "");
    drone.on_event("image", "*/*", [](const Event&) {});
    drone.main([over, result] {
        if (over->first && !std::exchange(over->second, true))
            result.end();
        return 1s;
    });
}

struct Ring {
    explicit Ring(int size)
    {
        simulation::enter_empty_home();
        for (int i = 0; i < size; ++i)
            names.push_back("drone-" + std::to_string(i));
        for (const auto& name : names)
            world.spawn(name, [name] {
                EmbeddedDrone embedded({"ring", "of a test"}, {.name = name});
                member_of_ring(embedded.drone());
                embedded.run();
            });
        world.spawn("operator", [this] { end_all(); });
        run(3s);
    }
    void end_all()
    {
        world.sleep(100ms);
        Application::Options options;
        options.name = "operator";
        Application application(options);
        for (std::size_t i = 0; i < names.size(); ++i)
            application.connect({names[i], "result"}, {names[(i + 1) % names.size()], "image"});
        application.set(names.front(), {{"over", true}});
    }
    /// When the ends of all these drones are known.
    void ask(const std::string& name, const std::vector<std::string>& drones)
    {
        world.spawn(name, [this, name, drones] {
            Application::Options options;
            options.name = name;
            Application application(options);
            std::vector<Endpoint> outputs;
            for (const auto& drone : drones)
                outputs.push_back({drone, "result"});
            const auto begun = world.now();
            const auto collector = application.collect(outputs);
            while (!collector->ended())
                static_cast<void>(collector->next(10ms));
            longest = std::max(longest, world.now() - begun);
            ++told;
        });
    }
    /// What happens meanwhile.
    std::uint64_t run(std::chrono::milliseconds time)
    {
        const auto before = world.handlers();
        for (const auto limit = world.now() + time; world.step(limit);) {
        }
        return world.handlers() - before;
    }

    World world{1};
    std::vector<std::string> names;
    simulation::Duration longest{};
    int told = 0;
};

}  // namespace

TEST_CASE("ends: of drones in a circle, who asks is told within 2 s, and then nobody asks any more")
{
    for (const int size : {2, 3, 5}) {
        Ring ring(size);
        const auto quiet = ring.run(5s);
        ring.ask("one", {ring.names.front()});
        ring.ask("other", {ring.names.back()});
        ring.ask("all", ring.names);
        ring.run(10s);
        CHECK(ring.told == 3);
        CHECK(ring.longest < 2100ms);
        CHECK(ring.run(5s) < quiet + quiet / 10);
    }
}
