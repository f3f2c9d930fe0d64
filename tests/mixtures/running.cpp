// Processes, signals and the calls of an application.
#include "running.hpp"
#include "orders.hpp"
#include "recordings.hpp"
#include "swarm_file.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <future>
#include <stdexcept>
#include <sys/prctl.h>
#include <thread>

namespace hive::mixtures {
namespace {

using namespace std::chrono_literals;

std::string kind_of(const std::string& drone)
{
    const bool by_name = drone == forker || drone == joiner;
    return drone == source ? "ticker" : drone == recorder ? "record" : by_name ? drone : "sleeper";
}

/// Descriptors and mappings of shared memory of this process itself.
std::size_t held_here()
{
    const auto maps = test::text_of("/proc/self/maps");
    std::size_t mapped = 0;
    for (auto at = maps.find("memfd:"); at != std::string::npos; at = maps.find("memfd:", at + 1))
        ++mapped;
    return test::open_descriptors(::getpid()) + mapped;
}

}  // namespace

Running::Running(const Topology& topology, const Extras& extras) : topology_(topology), extras_(extras)
{
    if (extras_.up)
        up(true);
    for (const auto& drone : topology_.drones()) {
        if (!extras_.up)
            start(drone, false);
        born_[drone] = 0;
    }
    collecting_.emplace(swarm_, topology_);
    if (topology_.is_bystander(forker)) {
        start(joiner, false);
        branch_.emplace(Application::Options{.name = "branch", .home = swarm_.home(), .timeout = test::stated(5000ms)});
        branching_ = std::jthread([this](const std::stop_token& ending) {
            while (branch_->take(20ms) || !ending.stop_requested())
                std::this_thread::sleep_for(1ms);  // at its end it does not wait
        });
    }
    if (!extras_.command)
        return;
    command_.emplace(swarm_, topology_);
    const auto collected = [&](const std::string& drone) { return collectors_of(statuses(), drone) == collectors(); };
    if (!test::eventually([&] { return std::ranges::all_of(topology_.stages.back().drones, collected); }))
        throw std::runtime_error("hivectl results does not connect:\n" + swarm_.log("results"));
}

void Running::at_once(const std::function<void()>& one, const std::function<void()>& other)
{
    auto beside = std::async(std::launch::async, one);
    other();
    beside.get();
}

std::chrono::milliseconds Running::stillness() const { return test::sanitized() ? 3000ms : Ground::stillness(); }

std::chrono::milliseconds Running::longest_settling() const
{
    return Ground::longest_settling() * (test::sanitized() ? 2 : 1);
}

std::vector<std::string> Running::first_settings(const std::string& drone) const
{
    if (drone == source)
        return {std::string("pace=") + (topology_.demand ? "demand" : "live"), "fps=200", "bytes=100",
                std::string("ends=") + (extras_.ends ? "true" : "false"), "count=" + std::to_string(fed_)};
    if (drone == recorder)
        return {"file=" + (swarm_.home() / "run.hive").string()};
    if (!topology_.is_worker(drone))
        return {};
    return {"work_ms=" + std::to_string(first_setting.work_ms), "most_ms=" + std::to_string(first_setting.most_ms),
            "throw_every=" + std::to_string(topology_.stages.at(topology_.stage_of(drone)).throw_every)};
}

void Running::start(const std::string& drone, bool remembers)
{
    if (drone == source && !remembers)
        fed_ = 1;
    born_[drone] = ++starts_;
    auto settings = remembers ? std::vector<std::string>{} : first_settings(drone);
    const auto of_swarm = extras_.up ? std::vector<std::string>{"--swarm", swarm_name} : std::vector<std::string>{};
    processes_.insert_or_assign(drone, swarm_.drone(kind_of(drone), drone, settings, of_swarm));
    if (drone == source)
        numbering_.began(statuses_of(application_, {source}).at(source).epoch);
}

/// The first call starts and connects all drones, with a source that has halted until the collectors are there, and the
/// second one lets it go.
void Running::up(bool halted)
{
    if (::prctl(PR_SET_CHILD_SUBREAPER, 1) != 0)  // their exit codes are for this process
        throw std::runtime_error("cannot become a subreaper");
    const auto file = swarm_.home() / "round.json";
    std::ofstream(file) << swarm_file(topology_, [&](const std::string& drone) {
        return FileDrone{kind_of(drone), first_settings(drone), halted && drone == source};
    });
    swarm_.hivectl_done({"up", file.string()}, 60s);
    if (!processes_.empty())
        return;
    for (const auto& [drone, status] : statuses_of(application_, topology_.drones()))
        processes_.insert_or_assign(drone, test::Process::adopted(static_cast<pid_t>(status.pid)));
    numbering_.began(statuses_of(application_, {source}).at(source).epoch);
}

void Running::down(std::vector<std::string>& left)
{
    const auto down = swarm_.hivectl({"down", (swarm_.home() / "round.json").string()}, 30s);
    if (down.exit_code != 0)
        left.push_back("hivectl down exited with " + std::to_string(down.exit_code) + ":\n" + down.out + down.err);
}

void Running::connect(const Edge& edge)
{
    application_.connect({edge.sender, Topology::output_of(edge.sender)},
                         {edge.receiver, Topology::input_of(edge.receiver)}, edge.options);
}

bool Running::begin(const std::vector<Edge>& edges)
{
    if (!extras_.up)
        return Ground::begin(edges);
    up(false);
    return true;
}

std::vector<ConnectAnswer> Running::connect(const std::vector<SwarmConnection>& connections,
                                            std::chrono::milliseconds timeout)
{
    return swarm_.application(timeout).connect(connections);
}

void Running::perform(const Step& step)
{
    switch (step.verb) {
    case Verb::feed: return feed(step.number);
    case Verb::connect:
    case Verb::change: return connect(topology_.edge_of(step));
    case Verb::disconnect: return application_.disconnect({step.sender, ""}, {step.drone, ""});
    case Verb::kill:
        processes_.at(step.drone).kill();
        killed_.insert(step.drone);
        frozen_.erase(step.drone);
        return;
    case Verb::start: return start(step.drone, killed_.erase(step.drone) > 0);
    case Verb::freeze:
        processes_.at(step.drone).signal(SIGSTOP);
        frozen_[step.drone] = test::Clock::now();
        return;
    case Verb::thaw:
        std::this_thread::sleep_until(frozen_.at(step.drone) + std::chrono::milliseconds(step.number));
        processes_.at(step.drone).signal(SIGCONT);
        frozen_.erase(step.drone);
        return;
    case Verb::halt: return application_.halt(step.drone);
    case Verb::resume: return application_.resume(step.drone);
    case Verb::stop:
        application_.stop(step.drone);
        processes_.erase(step.drone);
        return;
    default: return;
    }
}

void Running::feed(int events)
{
    const auto produced = statuses().at(source).outputs.at(0).produced;
    fed_ = std::max(fed_, produced) + events;
    application_.set(source, {{"count", fed_}});
}

Told Running::set(const Change& change)
{
    Application asking = swarm_.application();  // of its own: two may be under way
    return mixtures::set(asking, change);
}

std::vector<std::string> Running::answering() const
{
    auto names = topology_.drones();
    std::erase_if(names, [&](const auto& drone) {
        return killed_.contains(drone) || !processes_.contains(drone) || frozen_.contains(drone);
    });
    return names;
}

Statuses Running::statuses() { return statuses_of(application_, answering()); }

Settings Running::settings() { return settings_of(application_, answering()); }

std::int64_t Running::count() { return application_.get(source, {"count"}).at("count"); }

std::optional<Printed> Running::end_source()
{
    if (!command_)
        return std::nullopt;
    application_.set(source, {{"ends", true}});
    auto printed = command_->exited(longest_settling());
    command_.reset();
    return printed;
}

std::vector<std::string> Running::fallen()
{
    auto fallen = command_ ? command_->fallen() : std::vector<std::string>{};
    for (auto& [drone, process] : processes_)
        if (!killed_.contains(drone))
            if (const auto code = process.wait(0ms))
                fallen.push_back(drone + " ended by itself with " + std::to_string(*code) + ":\n" + swarm_.log(drone));
    return fallen;
}

std::vector<std::string> Running::end()
{
    std::vector<std::string> left;
    if (extras_.up)
        down(left);
    for (auto& [drone, process] : processes_) {
        if (!extras_.up || drone == joiner)
            application_.stop(drone);
        if (const auto code = process.wait(test::patient(5000ms)); code != 0)
            left.push_back(drone + (code ? " ended with " + std::to_string(*code) : " still runs") + " after stop:\n"
                           + swarm_.log(drone));
    }
    for (const auto& drone : application_.remembered())
        left.push_back(drone + " is still remembered");
    for (const auto& entry : std::filesystem::directory_iterator(swarm_.home()))
        if (entry.path().extension() == ".sock")
            left.push_back(entry.path().filename().string() + " is left");
    return left;
}

std::vector<Received> Running::received()
{
    std::vector<Received> all;
    if (topology_.is_bystander(recorder))
        all.push_back(recorded_in(swarm_.home(), numbering_));
    if (branch_) {
        branching_ = {};  // waits for its end
        const auto place = [this](const Identity& identity, std::int64_t index) {
            return std::pair(numbering_.run_of(identity.epoch), index);
        };
        std::ranges::move(branch_->received(place), std::back_inserter(all));
    }
    return all;
}

Played play(const Plan& plan)
{
    const auto held = held_here();
    const auto extras = make_extras(plan.seed);
    auto plan_here = plan;
    plan_here.topology.bystanders = extras.bystanders;
    if (extras.ends)
        plan_here.faults.insert(fault::ends);
    Played played;
    try {
        Running running(plan_here.topology, extras);
        played = Round(plan_here, running).play();
    } catch (const std::exception& error) {
        played.problems = {std::string("the round did not begin or end: ") + error.what()};
    }
    if (!test::eventually([&] { return held_here() <= held; }))
        played.problems.push_back("descriptors or shared memory are left: " + std::to_string(held_here()) + ", before "
                                  + std::to_string(held));
    played.picture = "beside the plan: " + to_text(extras) + "\n" + played.picture;
    return played;
}

}  // namespace hive::mixtures
