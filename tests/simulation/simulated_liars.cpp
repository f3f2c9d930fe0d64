// Members of the swarm that lie to a drone of the round, or to one of their own.
#include "drones.hpp"
#include "lies.hpp"
#include "simulated_ground.hpp"

#include <algorithm>

namespace hive::simulation {

using namespace std::chrono_literals;

/// Receives from a drone until it dies, without effect on other receivers: a source does not wait for receivers of
/// notifications, and exceptions wait for no receiver.
void SimulatedGround::receive_as_liar(const std::string& name, const std::string& from)
try {
    const bool exceptions = world_.chance(50);
    const ConnectionOptions options{
        .transfer = world_.chance(50) ? Transfer::streaming : Transfer::synchronized,
        .delivery = exceptions ? Delivery::data : Delivery::notification,
        .window = static_cast<int>(1 + world_.chance_of(8)),
        .group = {},
        .lease = {},
    };
    Application application(application_named(name, short_timeout));
    static_cast<void>(application.status({from}));
    const auto output = exceptions ? "exceptions" : mixtures::Topology::output_of(from);
    const auto collector = application.collect({{from, output}}, {.connection = options});
    for (;;)
        if (!collector->next(10ms) && collector->ended())
            world_.sleep(10ms);  // a source may go on
} catch (const Error& error) {
    trace_.line(name, error.what());
}

/// Its only receiver is a drone that is not in the round.
void SimulatedGround::send_as_liar(const std::string& name)
{
    EmbeddedDrone embedded(
        {"ticker", "that lies"},
        {.name = name,
         .parameters = {{"pace", world_.chance(50) ? "demand" : "live"}, {"fps", 200}, {"count", 500}},
         .log = log_of(name)});
    source(embedded.drone());
    embedded.run();
}

void SimulatedGround::listen_to_liar(const std::string& name, const std::string& liar)
{
    EmbeddedDrone embedded({"sleeper", "of a liar"},
                           {.name = name, .connect = {"image=" + liar + ".tick"}, .log = log_of(name)});
    worker(embedded.drone());
    embedded.run();
}

Process& SimulatedGround::spawn_liar(const std::string& name, std::function<void()> main)
{
    Process& liar = world_.spawn(name, std::move(main));
    links_.lies(liar.pid);
    guests_.push_back(&liar);
    let_lie(liar, static_cast<int>(world_.chance_of(10)),
            [this, name](const std::string& lie) { trace_.line(name, "lies: " + lie); });
    return liar;
}

/// One at a time, until it is killed.
void SimulatedGround::lie_sometimes()
{
    const auto names = answering();
    const auto dead = [](const Process* guest) { return guest->dead; };
    if (!has(mixtures::fault::lie) || !std::ranges::all_of(guests_, dead) || names.empty() || !world_.chance(40))
        return;
    const auto name = mixtures::liar + std::to_string(++liars_);
    Process *liar = nullptr, *victim = nullptr;
    if (world_.chance(60)) {
        const auto from = names[world_.chance_of(names.size())];
        liar = &spawn_liar(name, [this, name, from] { receive_as_liar(name, from); });
    } else {
        liar = &spawn_liar(name, [this, name] { send_as_liar(name); });
        const auto receiver = "victim-" + std::to_string(liars_);
        victim = &world_.spawn(receiver, [this, receiver, name] { listen_to_liar(receiver, name); });
        guests_.push_back(victim);
    }
    world_.at(world_.now() + world_.between(50ms, 800ms), [this, liar, victim, alive = std::weak_ptr(alive_)] {
        if (alive.expired())
            return;
        world_.kill(*liar);
        if (!victim)
            return;
        if (victim->dead)
            fallen_.push_back("lie: " + victim->name + " ended by itself: " + victim->failure);
        world_.kill(*victim);
    });
}

}  // namespace hive::simulation
