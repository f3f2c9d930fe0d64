// Executes orders on simulated drones.
#include "network.hpp"
#include "simulated_ground.hpp"

#include <orders.hpp>

#include <algorithm>
#include <utility>

namespace hive::simulation {

using namespace std::chrono_literals;
using mixtures::Change;
using mixtures::Edge;
using mixtures::Step;
using mixtures::Told;
using mixtures::Topology;
using mixtures::Verb;

void SimulatedGround::connect(const Edge& edge)
{
    auto unplugged = unplug_sometimes();
    calls_.keep("connect", [&] {
        application_->connect({edge.sender, Topology::output_of(edge.sender)},
                              {edge.receiver, Topology::input_of(edge.receiver)}, edge.options);
    });
    plug_in(std::move(unplugged));
}

std::vector<ConnectAnswer> SimulatedGround::connect(const std::vector<SwarmConnection>& connections,
                                                    std::chrono::milliseconds timeout)
{
    until([this] { return world_.now() >= reachable_from_ && all_hear(); });
    Application application(application_named("connector-" + std::to_string(++callers_), timeout));
    auto& calls = timeout < short_timeout ? impatient_calls_ : calls_;
    auto unplugged = unplug_sometimes();
    const auto answers = calls.keep("connect all", [&] { return application.connect(connections); });
    plug_in(std::move(unplugged));
    return answers;
}

/// A verb that reaches a drone through another one may wait while the link between the two is silenced.
void SimulatedGround::perform(const Step& step)
{
    trace_.line("step", to_text(step));
    cut_sometimes();
    set_clock_sometimes();
    lie_sometimes();
    disturbances_ += step.verb == Verb::feed || step.verb == Verb::rest ? 0 : 1;
    const std::set local{Verb::kill, Verb::start, Verb::freeze, Verb::thaw, Verb::rest};
    if (!local.contains(step.verb))
        until([this] { return world_.now() >= reachable_from_; });
    if (step.verb == Verb::connect || step.verb == Verb::change || step.verb == Verb::disconnect)
        wait_until_heard();
    else
        silence_sometimes();
    stops_ = step.verb == Verb::stop;
    perform_now(step);
    stops_ = false;
    if (has(mixtures::fault::clocks) || has(mixtures::fault::part))
        world_.sleep(20ms);  // until all that the network had for an earlier run has been refused
}

void SimulatedGround::perform_now(const Step& step)
{
    switch (step.verb) {
    case Verb::feed: return feed(step.number);
    case Verb::connect:
    case Verb::change: return connect(topology_.edge_of(step));
    case Verb::disconnect:
        return calls_.keep("disconnect", [&] { application_->disconnect({step.sender, ""}, {step.drone, ""}); });
    case Verb::forget: return forget(step);
    case Verb::kill: return kill(step.drone);
    case Verb::start: return killed_.contains(step.drone) ? restart(step.drone) : start(step.drone, false);
    case Verb::freeze: return freeze(step.drone);
    case Verb::thaw: return thaw(step.drone, std::chrono::milliseconds(step.number));
    case Verb::halt: return calls_.keep("halt", [&] { application_->halt(step.drone); });
    case Verb::resume: return calls_.keep("resume", [&] { application_->resume(step.drone); });
    case Verb::stop: return stop(step);
    case Verb::fail: return fail(step);
    case Verb::part: return part(std::chrono::milliseconds(step.number), step.second);
    case Verb::replace: return replace(step);
    default: return;
    }
}

/// A restarted sender may not know the receiver.
void SimulatedGround::forget(const Step& step)
try {
    calls_.keep("disconnect", [&] { application_->disconnect({step.sender, ""}, {step.drone, ""}); });
} catch (const Error& error) {
    if (error.code() != Errc::unreachable && error.code() != Errc::not_found)
        throw;
}

void SimulatedGround::kill(const std::string& drone)
{
    links_.broken(drone, world_.now());
    Process& process = *running_.at(drone)->process;
    if (has(mixtures::fault::crash_point) && !process.writes_left)
        process.writes_left = static_cast<int>(world_.chance_of(12));
    if (process.writes_left)
        die_while_writing(process);
    world_.kill(process);
    killed_.insert(drone);
    frozen_.erase(drone);
}

/// Or a while later, if it does not write.
void SimulatedGround::die_while_writing(Process& process)
{
    for (const auto last = world_.now() + 100ms; !process.dead && world_.now() < last;)
        world_.sleep(1ms);
}

/// It may die once more before it is back.
void SimulatedGround::restart(const std::string& drone)
{
    if (has(mixtures::fault::crash_point) && world_.chance(40)) {
        start(drone, true, static_cast<int>(world_.chance_of(30)));
        kill(drone);
    }
    killed_.erase(drone);
    start(drone, true);
}

/// One that hangs is killed when its grace period is over.
void SimulatedGround::stop(const Step& step)
{
    const auto& drone = step.drone;
    if (step.second == 1)
        failed_by(step, mixtures::Failure::hangs, 1h);
    links_.broken(drone, world_.now());
    calls_.keep("stop", [&] { application_->stop(drone); });
    until([process = running_.at(drone)->process] { return process->dead; });  // it uses its row to the end
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
    running_.at(drone)->process->frozen = true;
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
    running_.at(drone)->process->frozen = false;
    frozen_.erase(drone);
    links_.thawed(drone, world_.now());
}

/// Between two drones, some time after a step. The collector keeps its connections, because exceptions wait for no
/// receiver.
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
        if (found == running_.end() || found->second->process->dead)
            return;
        const auto drones = topology_.drones();
        const auto peer = cut_one_connection(*found->second->process, [&](const Process& other) {
            return other.name != name && std::ranges::count(drones, other.name) > 0;
        });
        if (peer.empty())
            return;
        ++disturbances_;
        trace_.line("network", "cut " + name + " - " + peer);
        links_.cut(name, peer, world_.now());
        if (machine_of(name) != machine_of(peer))
            cut_.emplace(name, peer);
    });
}

/// The caller loses connections as long as the result exists.
std::shared_ptr<void> SimulatedGround::unplug_sometimes()
{
    if (!has(mixtures::fault::unplug) || !world_.chance(60))
        return nullptr;
    const std::shared_ptr<void> unplugged = std::make_shared<bool>(true);
    for (auto times = 1 + world_.chance_of(3); times > 0; --times)
        world_.at(world_.now() + world_.between(0ms, 4ms),
                  [this, caller = world_.current(), during = std::weak_ptr(unplugged)] {
                      if (during.expired())
                          return;
                      const auto drones = topology_.drones();
                      const auto peer = cut_one_connection(
                          *caller, [&](const Process& other) { return std::ranges::count(drones, other.name) > 0; });
                      if (!peer.empty())
                          trace_.line("network", "cut " + caller->name + " - " + peer);
                  });
    return unplugged;
}

/// A set over a connection that was just cut would not be repeated.
void SimulatedGround::plug_in(std::shared_ptr<void>&& unplugged)
{
    if (std::exchange(unplugged, nullptr))
        world_.sleep(1ms);
}

void SimulatedGround::set_clock_sometimes()
{
    if (!has(mixtures::fault::clock_step) || !world_.chance(25))
        return;
    const auto step = world_.between(-1h, 1h);
    trace_.line("clock",
                "set by " + std::to_string(std::chrono::duration_cast<std::chrono::seconds>(step).count()) + " s");
    world_.set_time_of_day(world_.time_of_day() + step);
}

/// Long enough to be declared dead, or not. One at a time.
void SimulatedGround::silence_sometimes()
{
    if (!has(mixtures::fault::silence) || !all_hear() || !world_.chance(25))
        return;
    const auto names = answering();
    if (names.empty())
        return;
    const auto drones = topology_.drones();
    const auto until = world_.now() + world_.between(50ms, 3500ms);
    auto& process = *running_.at(names[world_.chance_of(names.size())])->process;
    const auto peer = silence_one_connection(
        process, [&](const Process& other) { return std::ranges::count(drones, other.name) > 0; }, until);
    if (peer.empty())
        return;
    silent_until_ = until;
    ++disturbances_;
    trace_.line("network", "between " + process.name + " and " + peer + " one does not hear the other");
    links_.silent(process.name, peer, world_.now(), until);
}

/// @param way  0: both directions
void SimulatedGround::part(std::chrono::milliseconds time, int way)
{
    const auto until = world_.now() + time;
    silent_until_ = std::max(silent_until_, until);
    reachable_from_ = silent_until_ + 1s;  // what has ended is opened again
    for (const auto& drone : peers(topology_))
        for (const auto& other : peers(topology_))
            if (machine_of(drone) < machine_of(other))
                links_.silent(drone, other, world_.now(), until);
    if (way != 1)
        part_machines(0, 1, until);
    if (way != 2)
        part_machines(1, 0, until);
}

void SimulatedGround::wait_until_heard()
{
    until([this] { return all_hear(); });
}

void SimulatedGround::feed(int events)
{
    const auto produced = statuses().at(mixtures::source).outputs.at(0).produced;
    fed_ = std::max(fed_, produced) + events;
    calls_.keep("set", [&] { application_->set(mixtures::source, {{"count", fed_}}); });
    watch_sometimes();
}

Told SimulatedGround::set(const Change& change)
{
    Application asking(application_named("setter-" + std::to_string(world_.current()->pid)));  // two may be under way
    return calls_.keep("set on many", [&] { return mixtures::set(asking, change); });
}

}  // namespace hive::simulation
