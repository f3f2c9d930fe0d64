// Applications that start to collect right after the source got more work: if one gets an end, it must be the end after
// all that work.
#include "simulated_ground.hpp"

#include <algorithm>

namespace hive::simulation {

using namespace std::chrono_literals;

bool SimulatedGround::all_answer()
{
    const auto connected = [](const auto& row) {
        return std::ranges::all_of(row.second.inputs, &InputStatus::connected);
    };
    const auto all = statuses();
    return all_hear() && all.size() == topology_.drones().size() && std::ranges::all_of(all, connected);
}

/// One at a time. It receives notifications, so that no drone waits for it.
void SimulatedGround::watch_sometimes()
{
    const auto dead = [](const Process* guest) { return guest->dead; };
    if (!has(mixtures::fault::ends) || !all_answer() || !std::ranges::all_of(guests_, dead) || !world_.chance(50))
        return;
    const auto name = "watcher-" + std::to_string(++watchers_);
    watching_ = guests_.emplace_back(&world_.spawn(name, [this, name] { watch_until_the_end(name); }));
}

/// After a fault in between, the old state may be returned after 1 s, and by a drone that is being stopped at once.
void SimulatedGround::watch_until_the_end(const std::string& name)
try {
    const auto before = disturbances_;
    const auto fed = fed_;
    Application application(application_named(name, short_timeout));
    const auto collector =
        application.collect(ends(), {.connection = {.delivery = Delivery::notification, .group = {}, .lease = {}}});
    for (const auto last = world_.now() + 5s; world_.now() < last && !ending_ && !collector->ended();)
        static_cast<void>(collector->next(10ms));
    const auto produced = statuses().at(mixtures::source).outputs.at(0).produced;
    if (collector->ended() && disturbances_ == before && !stops_ && all_answer() && produced < fed)
        wrong_ends_.push_back("end: who began to watch when the source might make " + std::to_string(fed)
                              + " events was told the end after " + std::to_string(produced));
} catch (const Error& error) {
    trace_.line(name, error.what());
}

}  // namespace hive::simulation
