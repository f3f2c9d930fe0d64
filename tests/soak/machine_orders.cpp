// What is done to the drones and to the network: signals, hivectl and the calls of an application.
#include "machines.hpp"

#include <checks.hpp>
#include <orders.hpp>

#include <algorithm>
#include <csignal>
#include <stdexcept>

namespace hive::soak {
namespace {

using namespace std::chrono_literals;
using namespace mixtures;

constexpr int first_port = 7700;

std::string first_settings(const std::string& drone, std::int64_t fed)
{
    if (drone == source)
        return "pace=demand bytes=2000 ends=false count=" + std::to_string(fed);
    if (drone == watcher)
        return "";
    return "work_ms=" + std::to_string(first_setting.work_ms) + " most_ms=" + std::to_string(first_setting.most_ms);
}

std::string kind_of(const std::string& drone) { return drone == source ? "ticker" : "sleeper"; }

std::string printed(const test::Finished& done) { return done.out + done.err; }

}  // namespace

void Machines::begun(const std::string& drone)
{
    born_[drone] = ++starts_;
    came_.failures.erase(drone);
    came_.given_up.erase(drone);
    pids_[drone] = static_cast<pid_t>(local(drone).status(drone).pid);
}

/// By the operator, over ssh.
void Machines::start(const std::string& drone, bool remembers)
{
    if (remembers)
        return start_again(drone);
    if (drone == source)
        fed_ = 1;
    const auto drones = swarm_.topology.drones();
    const auto port = first_port + (std::ranges::find(drones, drone) - drones.begin());
    lab_.hivectl_done("start " + kind_of(drone) + " --as " + drone + " --on " + swarm_.places.at(drone)
                      + " --listen tcp://0.0.0.0:" + std::to_string(port) + " " + first_settings(drone, fed_));
    begun(drone);
}

/// On its machine, as systemd would.
void Machines::start_again(const std::string& drone)
{
    const auto& machine = lab_.machine(machine_of(drone));
    const auto hivectl = machine.swarm.program("hivectl").string();
    const auto done = machine.swarm.run(machine.net.inside({hivectl, "start", kind_of(drone), "--as", drone}), 30s);
    if (done.exit_code != 0)
        throw std::runtime_error("hivectl start " + drone + ": " + printed(done));
    begun(drone);
    if (drone == source)
        forget_many();
}

/// A source that starts again makes all its events again: only few of them.
void Machines::forget_many()
{
    auto& application = local(source);
    application.set(source, {{"count", 1}});
    fed_ = std::max<std::int64_t>(1, application.status(source).outputs.at(0).produced);
    application.set(source, {{"count", fed_}});
}

void Machines::connect(const Edge& edge)
{
    application_->connect({edge.sender, Topology::output_of(edge.sender)}, {edge.receiver, "image"}, edge.options);
}

/// The soak connects one at a time.
std::vector<ConnectAnswer> Machines::connect(const std::vector<SwarmConnection>& connections,
                                             std::chrono::milliseconds /*timeout*/)
{
    return application_->connect(connections);
}

void Machines::perform(const Step& step)
{
    switch (step.verb) {
    case Verb::feed: return feed(step.number);
    case Verb::connect:
    case Verb::change: return connect(swarm_.topology.edge_of(step));
    case Verb::disconnect: return application_->disconnect({step.sender, ""}, {step.drone, ""});
    case Verb::kill: {
        const auto pid = pids_.at(step.drone);
        ::kill(pid, SIGKILL);
        pids_.erase(step.drone);
        killed_.insert(step.drone);
        if (!test::eventually([&] { return !runs(pid); }))
            throw std::runtime_error(step.drone + " does not die");
        return;
    }
    case Verb::start: return start(step.drone, killed_.erase(step.drone) > 0);
    case Verb::freeze:
        frozen_[step.drone] = now();
        ::kill(pids_.at(step.drone), SIGSTOP);
        return;
    case Verb::thaw:
        std::this_thread::sleep_until(frozen_.at(step.drone) + std::chrono::milliseconds(step.number));
        ::kill(pids_.at(step.drone), SIGCONT);
        frozen_.erase(step.drone);
        return;
    case Verb::halt: return application_->halt(step.drone);
    case Verb::resume: return application_->resume(step.drone);
    case Verb::stop:
        application_->stop(step.drone);
        pids_.erase(step.drone);
        return;
    case Verb::replace: {
        pids_.erase(step.drone);
        const auto done = lab_.shell("hivectl replace " + step.drone + " --timeout 60", 120s);
        if (done.exit_code != 0)
            throw std::runtime_error("hivectl replace " + step.drone + ": " + printed(done));
        begun(step.drone);
        if (step.drone == source)
            forget_many();
        return;
    }
    case Verb::fail: return fail(step.drone);
    default: return network(step);
    }
}

void Machines::network(const Step& step)
{
    switch (step.verb) {
    case Verb::cut: lab_.cut(number_of(step.drone)); break;
    case Verb::mend: lab_.mend(number_of(step.drone)); break;
    case Verb::swallow: lab_.swallow(number_of(step.sender), number_of(step.drone)); break;
    case Verb::let_through: lab_.let_through(number_of(step.sender), number_of(step.drone)); break;
    default: return;
    }
    network_failures_ += step.verb == Verb::cut || step.verb == Verb::swallow ? 1 : -1;
    network_whole_ = now();
}

void Machines::feed(int events)
{
    const auto produced = local(source).status(source).outputs.at(0).produced;
    fed_ = std::max(fed_, produced) + events;
    local(source).set(source, {{"count", fed_}});
}

/// Switched off afterwards: a restarted drone would throw again.
void Machines::fail(const std::string& drone)
{
    constexpr int events_of_all = 100;  // of which the drone gets at least one
    if (!test::eventually([&] { return heard(statuses(), drone); }))
        throw std::runtime_error("no application receives the exceptions of " + drone);
    const auto abandoned = [&] {
        std::int64_t sum = 0;
        for (const auto& input : local(drone).status(drone).inputs)
            sum += input.abandoned;
        return sum;
    };
    const auto before = abandoned();
    local(drone).set(drone, {{"throw_at", 1 + fails_++ % 5}});
    const auto fails = [&] {
        if (local(source).status(source).outputs.at(0).produced >= fed_)
            feed(events_of_all);
        return abandoned() > before;
    };
    if (!test::eventually(fails))
        throw std::runtime_error(drone + " throws nothing");
    local(drone).set(drone, {{"throw_at", 0}});
}

Told Machines::set(const Change& change)
{
    Application asking({.name = {}, .home = lab_.laptop().home(), .timeout = 20s});  // two may be under way
    return mixtures::set(asking, change);
}

}  // namespace hive::soak
