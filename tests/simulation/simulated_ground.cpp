// The life of simulated drones, and what is done to them.
#include "drones.hpp"
#include "network.hpp"
#include "simulated_ground.hpp"

#include <orders.hpp>

#include <algorithm>
#include <iomanip>
#include <iostream>

namespace hive::simulation {

using namespace std::chrono_literals;
using mixtures::Change;
using mixtures::Edge;
using mixtures::Statuses;
using mixtures::Step;
using mixtures::Told;
using mixtures::Topology;
using mixtures::Verb;

namespace {

Json first_parameters(const Topology& topology, const std::string& drone, std::int64_t fed)
{
    if (drone == mixtures::source)
        return {{"pace", topology.demand ? "demand" : "live"}, {"fps", 200}, {"count", fed}};
    if (drone == mixtures::watcher)
        return Json::object();
    return {{"work_ms", mixtures::first_setting.work_ms},
            {"most_ms", mixtures::first_setting.most_ms},
            {"throw_every", topology.stages.at(topology.stage_of(drone)).throw_every}};
}

Application::Options application_named(const std::string& name)
{
    Application::Options options;
    options.name = name;
    return options;
}

}  // namespace

void Trace::line(const std::string& who, const std::string& what) const
{
    if (wanted_)
        std::cout << std::fixed << std::setprecision(6) << std::chrono::duration<double>(world().age()).count() << "  "
                  << who << ": " << what << "\n";
}

SimulatedGround::SimulatedGround(World& world, const Topology& topology, const Trace& trace)
    : world_(world), topology_(topology), trace_(trace)
{
    for (const auto& drone : topology_.drones()) {
        start(drone, false);
        born_[drone] = 0;
    }
    collected_.process = &world_.spawn("collector", [this] { collect(); });
    until([this] { return collected_.begun; });
    application_.emplace(application_named("operator"));
}

/// Of a round that failed the drones still run, and they use this.
SimulatedGround::~SimulatedGround()
{
    for (const auto& [drone, running] : running_)
        world_.kill(*running.process);
    if (world_.current()->dead) {
        world_.kill(*collected_.process);
        return;
    }
    collected_.ending = true;
    until([this] { return collected_.process->dead; });
}

void SimulatedGround::until(const std::function<bool()>& condition)
{
    while (!condition())
        world_.sleep(1ms);
}

void SimulatedGround::at_once(const std::function<void()>& one, const std::function<void()>& other)
{
    const auto& beside = world_.spawn("beside", one);
    other();
    until([&] { return beside.dead; });
}

// --- drones ---

void SimulatedGround::start(const std::string& drone, bool remembers)
{
    if (drone == mixtures::source && !remembers)
        fed_ = 1;
    born_[drone] = ++starts_;
    EmbeddedOptions options{.name = drone};
    if (!remembers)
        options.parameters = first_parameters(topology_, drone, fed_);
    options.log = [this, drone](LogLevel, const std::string& text) { trace_.line(drone, text); };
    Running& running = running_[drone] = {};
    running.process = &world_.spawn(drone, [this, drone, options] { live(drone, options); });
    until([&] { return running.ready || running.process->dead; });
}

void SimulatedGround::live(const std::string& name, EmbeddedOptions options)
{
    EmbeddedDrone embedded({name == mixtures::source ? "ticker" : "sleeper", "of a simulated round"},
                           std::move(options));
    Running& running = running_[name];
    const std::shared_ptr<void> gone(nullptr, [&running](void*) { running.drone = nullptr; });
    Drone& drone = embedded.drone();
    (name == mixtures::source ? source : worker)(drone);
    drone.on_start([&] {
        running.drone = &drone;
        running.ready = true;
    });
    embedded.run();
}

/// Once more when the connection over which the receiver registers is cut.
void SimulatedGround::connect(const Edge& edge)
try {
    application_->connect({edge.sender, Topology::output_of(edge.sender)}, {edge.receiver, "image"}, edge.options);
} catch (const Error& error) {
    if (error.code() != Errc::connection_lost)
        throw;
    world_.sleep(100ms);
    application_->connect({edge.sender, Topology::output_of(edge.sender)}, {edge.receiver, "image"}, edge.options);
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
        for (const auto& edge : topology_.edges())
            if (edge.sender == step.sender && edge.receiver == step.drone)
                connect(edge);
        return;
    case Verb::disconnect: return application_->disconnect({step.sender, ""}, {step.drone, ""});
    case Verb::kill:
        world_.kill(*process);
        killed_.insert(step.drone);
        frozen_.erase(step.drone);
        return;
    case Verb::start: return start(step.drone, killed_.erase(step.drone) > 0);
    case Verb::freeze:
        process->frozen = true;
        frozen_[step.drone] = world_.now();
        return;
    case Verb::thaw:
        if (const auto least = frozen_.at(step.drone) + std::chrono::milliseconds(step.number); least > world_.now())
            world_.sleep(least - world_.now());
        process->frozen = false;
        frozen_.erase(step.drone);
        return;
    case Verb::halt: return application_->halt(step.drone);
    case Verb::resume: return application_->resume(step.drone);
    case Verb::stop:
        application_->stop(step.drone);
        until([&] { return process->dead; });  // it uses its row to the end
        running_.erase(step.drone);
        return;
    default: return;
    }
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
        if (!peer.empty())
            trace_.line("network", "cut " + name + " - " + peer);
    });
}

void SimulatedGround::feed(int events)
{
    const auto produced = statuses().at(mixtures::source).outputs.at(0).produced;
    fed_ = std::max(fed_, produced) + events;
    application_->set(mixtures::source, {{"count", fed_}});
}

Told SimulatedGround::set(const Change& change)
{
    Application asking(application_named("setter-" + std::to_string(world_.current()->pid)));  // two may be under way
    return mixtures::set(asking, change);
}

std::vector<std::string> SimulatedGround::answering() const
{
    auto names = topology_.drones();
    std::erase_if(names, [&](const auto& drone) {
        return killed_.contains(drone) || !running_.contains(drone) || frozen_.contains(drone);
    });
    return names;
}

Statuses SimulatedGround::statuses()
{
    Statuses statuses;
    for (const auto& name : answering())
        if (auto* const drone = running_.at(name).drone)
            statuses[name] = drone->status();
    return statuses;
}

mixtures::Settings SimulatedGround::settings() { return mixtures::settings_of(*application_, answering()); }

std::int64_t SimulatedGround::count() { return application_->get(mixtures::source, {"count"}).at("count"); }

std::vector<std::string> SimulatedGround::fallen()
{
    std::vector<std::string> fallen;
    for (const auto& [drone, running] : running_)
        if (!killed_.contains(drone) && running.process->dead)
            fallen.push_back(drone + " ended by itself: " + running.process->failure);
    return fallen;
}

std::vector<std::string> SimulatedGround::end()
{
    std::vector<std::string> left;
    for (const auto& [drone, running] : running_) {
        application_->stop(drone);
        const auto process = running.process;
        for (const auto last = world_.now() + 5s; !process->dead && world_.now() < last;)
            world_.sleep(1ms);
        if (!process->dead || !process->failure.empty())
            left.push_back(drone + (process->dead ? " ended with " + process->failure : " still runs") + " after stop");
    }
    for (const auto& drone : application_->remembered())
        left.push_back(drone + " is still remembered");
    return left;
}

// --- the collector ---

void SimulatedGround::take(const Event& event, bool failed)
{
    collected_.came.push_back(mixtures::outcome_of(event, failed));
    trace_.line("collector", std::to_string(event.identity.sequence) + ": " + to_text(collected_.came.back()));
}

void SimulatedGround::collect()
{
    Application application(application_named("collector")), hearing(application_named(mixtures::hearer));
    std::vector<Endpoint> ends;
    for (const auto& drone : topology_.stages.back().drones)
        ends.push_back({drone, Topology::output_of(drone)});
    const auto results = application.collect(ends, {.ordered = topology_.ordered});
    const auto exceptions = hearing.exceptions(topology_.drones());
    for (collected_.begun = true; !collected_.ending;) {
        if (const auto result = results->next(20ms))
            take(*result, false);
        const auto exception = exceptions->next(results->ended() ? 20ms : 0ms);  // one of the two waits
        if (exception && exception->identity.sequence > 0)
            take(*exception, true);
        collected_.counts = results->counts();
    }
}

}  // namespace hive::simulation
