// What is done to simulated drones.
#include "network.hpp"
#include "simulated_ground.hpp"

#include <orders.hpp>

#include <algorithm>

namespace hive::simulation {

using namespace std::chrono_literals;
using mixtures::Change;
using mixtures::Edge;
using mixtures::Step;
using mixtures::Told;
using mixtures::Topology;
using mixtures::Verb;

/// Once more when the connection over which the receiver registers is cut.
void SimulatedGround::connect(const Edge& edge)
{
    const auto connect = [&] {
        calls_.keep("connect", [&] {
            application_->connect({edge.sender, Topology::output_of(edge.sender)}, {edge.receiver, "image"},
                                  edge.options);
        });
    };
    try {
        connect();
    } catch (const Error& error) {
        if (error.code() != Errc::connection_lost)
            throw;
        world_.sleep(100ms);
        connect();
    }
}

void SimulatedGround::perform(const Step& step)
{
    trace_.line("step", to_text(step));
    cut_sometimes();
    const auto found = running_.find(step.drone);
    Process* const process = found == running_.end() ? nullptr : found->second.process;
    switch (step.verb) {
    case Verb::feed: return feed(step.number);
    case Verb::connect:
    case Verb::change: return connect(topology_.edge_of(step));
    case Verb::disconnect:
        return calls_.keep("disconnect", [&] { application_->disconnect({step.sender, ""}, {step.drone, ""}); });
    case Verb::kill:
        links_.broken(step.drone, world_.now());
        world_.kill(*process);
        killed_.insert(step.drone);
        frozen_.erase(step.drone);
        return;
    case Verb::start: return start(step.drone, killed_.erase(step.drone) > 0);
    case Verb::freeze: return freeze(step.drone);
    case Verb::thaw: return thaw(step.drone, std::chrono::milliseconds(step.number));
    case Verb::halt: return calls_.keep("halt", [&] { application_->halt(step.drone); });
    case Verb::resume: return calls_.keep("resume", [&] { application_->resume(step.drone); });
    case Verb::stop: return stop(step.drone);
    default: return;
    }
}

void SimulatedGround::stop(const std::string& drone)
{
    links_.broken(drone, world_.now());
    calls_.keep("stop", [&] { application_->stop(drone); });
    until([process = running_.at(drone).process] { return process->dead; });  // it uses its row to the end
    running_.erase(drone);
}

/// Whether it has an answer is another matter.
void SimulatedGround::ask_impatiently(const std::string& drone)
try {
    impatient_calls_.keep("get by a deadline of 1 s", [&] { impatient_->get(drone); });
} catch (const Error& error) {
    trace_.line("impatient", error.what());
}

void SimulatedGround::freeze(const std::string& drone)
{
    ask_impatiently(drone);  // so that there is a connection
    running_.at(drone).process->frozen = true;
    frozen_[drone] = world_.now();
    links_.frozen(drone, world_.now());
}

void SimulatedGround::thaw(const std::string& drone, std::chrono::milliseconds least)
{
    const auto until = frozen_.at(drone) + least;
    if (until > world_.now() + short_timeout + Deadline::margin)
        ask_impatiently(drone);
    if (until > world_.now())
        world_.sleep(until - world_.now());
    running_.at(drone).process->frozen = false;
    frozen_.erase(drone);
    links_.thawed(drone, world_.now());
}

/// Between two drones, a while after a step. Who collects keeps its connections: an exception waits for nobody.
void SimulatedGround::cut_sometimes()
{
    if (!world_.chance(30))
        return;
    const auto names = answering();
    if (names.empty())
        return;
    const auto name = names[world_.chance_of(names.size())];
    world_.at(world_.now() + world_.between(0ms, 60ms), [this, name, alive = std::weak_ptr(alive_)] {
        const auto found = alive.expired() ? running_.end() : running_.find(name);
        if (found == running_.end() || found->second.process->dead)
            return;
        const auto drones = topology_.drones();
        const auto peer = cut_one_connection(
            *found->second.process, [&](const Process& other) { return std::ranges::count(drones, other.name) > 0; });
        if (peer.empty())
            return;
        trace_.line("network", "cut " + name + " - " + peer);
        links_.cut(name, peer, world_.now());
    });
}

void SimulatedGround::feed(int events)
{
    const auto produced = statuses().at(mixtures::source).outputs.at(0).produced;
    fed_ = std::max(fed_, produced) + events;
    calls_.keep("set", [&] { application_->set(mixtures::source, {{"count", fed_}}); });
}

Told SimulatedGround::set(const Change& change)
{
    Application asking(application_named("setter-" + std::to_string(world_.current()->pid)));  // two may be under way
    return calls_.keep("set on many", [&] { return mixtures::set(asking, change); });
}

}  // namespace hive::simulation
