// Tries every change on the model, and keeps those that help.
#include "line.hpp"

#include <algorithm>
#include <cmath>

namespace hive::advising {
namespace {

using What = Proposal::What;
using Sure = Proposal::Sure;

constexpr double full = 0.95;
constexpr double gain_fps = 1.05, gain_latency = 0.9, noticeable_us = 1000;

bool is_full(const MachineLoad& machine) { return machine.processors > 0 && machine.busy >= full * machine.processors; }

/// The narrowest window with which the connection would not be the limit.
int window_for(const Stage& stage, double per_s)
{
    const double path = stage.round_trip_us + stage.encode_us + stage.transit_us;
    const double needed = per_s / stage.size() * (path + stage.work_us) / second_us;
    constexpr double spare = 1.2, max_window = 64;
    return static_cast<int>(std::clamp(std::ceil(needed * spare), 1.0, max_window));
}

/// What would limit the rate if this connection did not.
double rate_without_window(Line line, std::size_t i)
{
    line.stages[i].options.transfer = Transfer::streaming;
    return rate(line);
}

std::vector<Change> changes_of(const Line& line, std::size_t i)
{
    const auto& stage = line.stages[i];
    std::vector<Change> changes;
    if (stage.can_share)
        changes.push_back({.what = What::worker, .stage = i});
    const bool streaming = stage.options.transfer == Transfer::streaming;
    if (!streaming)
        if (const int window = window_for(stage, rate_without_window(line, i) / through(line, i));
            window > stage.options.window)
            changes.push_back({.what = What::window, .stage = i, .window = window});
    if (streaming)
        changes.push_back({.what = What::transfer, .stage = i});
    else if (stage.options.window > 1)
        changes.push_back({.what = What::window, .stage = i, .window = 1});
    if (!stage.remote && stage.encode_us > 0)
        changes.push_back({.what = What::encoding, .stage = i, .encoding = "raw"});
    if (line.as_jpeg.contains(i))
        changes.push_back({.what = What::encoding, .stage = i, .encoding = "jpeg"});
    return changes;
}

std::vector<Change> changes_of(const Line& line)
{
    std::vector<Change> changes;
    for (std::size_t i = 1; i < line.stages.size(); ++i)
        for (auto& change : changes_of(line, i))
            changes.push_back(std::move(change));
    if (const auto all = limits(line);
        !line.on_demand && !line.rate_parameter.empty() && all.size() > 1 && all[0].what != Station::What::source) {
        constexpr double below = 0.9;  // so that bursts do not wait either
        // Divided, so that 9.6 is not 9.600000000000001.
        if (const double steps = std::floor(below * rate(line) / through(line, 0) / line.rate_step + 1e-9); steps > 0)
            changes.push_back({.what = What::source_rate, .fps = steps / (1 / line.rate_step)});
    }
    for (const auto& [host, machine] : line.machines) {
        if (!is_full(machine))
            continue;
        const auto greatest =
            std::ranges::max_element(machine.drones, {}, &std::pair<const std::string, double>::second);
        if (greatest != machine.drones.end())
            changes.push_back({.what = What::halt, .name = greatest->first});
        for (const auto& [other, there] : line.machines)
            if (other != host && !there.ssh.empty() && !is_full(there))
                for (std::size_t i = 1; i < line.stages.size(); ++i)
                    if (line.stages[i].can_share && line.stages[i].hosts.contains(host))
                        changes.push_back({.what = What::machine, .stage = i, .name = other});
    }
    return changes;
}

/// If the processors are full, the measured work includes waiting for one. Code that computes most of the time is
/// assumed to compute all the time.
void free_processors(Line& line, const std::string& host)
{
    constexpr double computes = 0.3;
    for (auto& stage : line.stages)
        if (stage.hosts.contains(host) && stage.cpu_us > computes * stage.work_us)
            stage.work_us = std::min(stage.work_us, stage.cpu_us);
}

struct Doubt {
    Sure sure;
    const char* why;
};

Doubt doubt_of(const Line& line, const Change& change)
{
    const auto& stage = line.stages[change.stage];
    constexpr double fits = 0.15;
    if (std::abs(rate(line) / line.per_s() - 1) > fits)
        return {Sure::low, "the model does not explain the present rate"};
    if (change.what == What::machine)
        return {Sure::low, "the connection to that machine is not measured"};
    if (std::ranges::any_of(line.machines, [](const auto& machine) { return is_full(machine.second); })
        && change.what != What::halt)
        return {Sure::medium, "all processors are busy"};
    if (change.what == What::halt)
        return {Sure::medium, "how long drones wait for a processor is inferred"};
    if (stage.remote && stage.round_trip_us == 0)
        return {Sure::low, "the round trip is not measured"};
    if (change.what == What::worker && stage.remote && stage.transit_us > stage.work_us)
        return {Sure::medium, "how much more the connection carries is inferred"};
    if (change.what == What::encoding && change.encoding == "raw")
        return {Sure::medium, "how long the receiver decodes is not measured"};
    if (std::ranges::any_of(line.stages, [](const Stage& each) { return each.pass != 1; }))
        return {Sure::medium,
                "a drone on the way sends fewer or more events than it gets, depending on what they show"};
    if (std::ranges::any_of(line.stages, [](const Stage& each) { return each.share < 1; }))
        return {Sure::medium, "a drone on the way has other senders as well, whose part is inferred"};
    return {Sure::high, ""};
}

/// A change that leaves the model's rate as it is does not help, even if fewer events than that were measured.
bool helps(const Line& line, const Line& after, Goal goal, const Proposal& proposal)
{
    const double age = measured_latency(line).value_or(0);
    return goal == Goal::fps
               ? rate(after) >= gain_fps * rate(line) && proposal.predicted_per_s >= gain_fps * line.per_s()
               : age > 0 && proposal.predicted_us <= gain_latency * age && proposal.predicted_us <= age - noticeable_us;
}

}  // namespace

Line changed(Line line, const Change& change)
{
    auto& stage = line.stages[change.stage];
    switch (change.what) {
    case What::worker:
        stage.members.emplace_back("one more");
        ++stage.hosts[stage.host];
        break;
    case What::machine:
        stage.members.emplace_back("one more");
        ++stage.hosts[change.name];
        break;
    case What::window: stage.options.window = change.window; break;
    case What::transfer: stage.options.transfer = Transfer::synchronized; break;
    case What::encoding:
        if (change.encoding == "raw") {
            stage.encode_us = 0;
        } else {
            const auto& jpeg = line.as_jpeg.at(change.stage);
            const double smaller = stage.bytes > 0 ? std::min(1.0, jpeg.bytes / stage.bytes) : 1;
            const double receiving_us = std::max(0.0, stage.cpu_us - stage.work_us);  // outside of the drone's code
            stage.encode_us = jpeg.encode_us;
            stage.transit_us *= smaller;
            stage.cpu_us -= receiving_us * (1 - smaller);
        }
        break;
    case What::source_rate: line.stages.front().per_s = change.fps; break;
    case What::halt:
        for (auto& [host, machine] : line.machines)
            if (const auto drone = machine.drones.find(change.name); drone != machine.drones.end()) {
                machine.busy -= drone->second;
                machine.others = std::max(0.0, machine.others - drone->second);
                machine.drones.erase(drone);
                free_processors(line, host);
            }
        break;
    }
    return line;
}

std::vector<Candidate> candidates(const Line& line, Goal goal)
{
    std::vector<Candidate> found;
    if (!explains_rate(line))
        return found;
    const double fit = line.per_s() / rate(line), age = measured_latency(line).value_or(0);
    for (auto& change : changes_of(line)) {
        const auto after = changed(line, change);
        const auto [sure, why] = doubt_of(line, change);
        const auto now = limits(after);
        Proposal proposal{.what = change.what, .predicted_per_s = rate(after), .sure = sure, .unsure = why};
        // The measured rate is more accurate than the model.
        if (sure == Sure::low && std::isfinite(fit))
            proposal.predicted_per_s *= std::min(1.0, fit);
        if (age > 0)
            proposal.predicted_us = std::max(after.last().work_us, age + latency(after) - latency(line));
        if (!now.empty())
            proposal.next = now.front();
        if (helps(line, after, goal, proposal))
            found.push_back({change, proposal});
    }
    std::ranges::stable_sort(found, [&](const Candidate& one, const Candidate& other) {
        return goal == Goal::fps ? one.proposal.predicted_per_s > other.proposal.predicted_per_s
                                 : one.proposal.predicted_us < other.proposal.predicted_us;
    });
    return found;
}

}  // namespace hive::advising
