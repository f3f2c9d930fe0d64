// A world, its operator, and the home of the drones.
#include "crash.hpp"
#include "simulated_ground.hpp"
#include "simulation.hpp"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <unistd.h>

namespace hive::simulation {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Limit in simulated time: everything that ends is faster.
constexpr auto longest = 20min;

/// In memory; with a fixed name, because the name is sent over the network.
class Folder {
public:
    Folder()
    {
        auto path = (fs::path("/dev/shm") / "hive-simulation-XXXXXX").string();
        if (!::mkdtemp(path.data()))
            throw std::runtime_error("cannot make " + path);
        path_ = path;
        fs::current_path(path_);
        ::setenv("HIVE_HOME", "/proc/self/cwd/home", 1);
        ::setenv("HIVE_KEY", "none", 1);
    }
    ~Folder()
    {
        std::error_code ignored;
        fs::current_path("/", ignored);
        fs::remove_all(path_, ignored);
    }
    void empty() const { fs::remove_all(path_ / "home"); }

private:
    fs::path path_;
};

}  // namespace

void enter_empty_home()
{
    static const Folder folder;
    folder.empty();
}

Played play(const mixtures::Plan& plan, bool trace)
{
    enter_empty_home();
    say_in_a_crash(mixtures::options_of(plan));
    const Trace printed(trace);
    Played played;
    bool done = false;
    World world(plan.seed);
    world.spawn("operator", [&] {
        try {
            SimulatedGround ground(world, plan, printed);
            static_cast<mixtures::Played&>(played) = mixtures::Round(plan, ground).play();
        } catch (const std::exception& error) {
            played.problems = {std::string("the round did not begin or end: ") + error.what()};
        }
        done = true;
    });
    const auto limit = world.now() + longest;
    while (!done && world.step(limit)) {
    }
    if (!done)
        played.problems = {"the round does not end"};
    played.digest = world.digest();
    played.handlers = world.handlers();
    played.time = world.age();
    return played;
}

}  // namespace hive::simulation
