// Comparing the fates of events with the steps so far.
#include "fates.hpp"
#include "picture.hpp"

#include <algorithm>
#include <utility>

namespace hive::mixtures {

Fates::Fates(const Topology& topology, WasCut was_cut, bool silent)
    : was_cut_(std::move(was_cut)), known_{"collector", hearer, "branch"}, silent_(silent)
{
    for (const auto& drone : topology.drones())
        known_.insert(drone);
}

/// A process that is replaced or stopped ends while it leaves.
void Fates::before(const Step& step)
{
    const std::set ends{Verb::kill, Verb::set_and_kill, Verb::fail, Verb::stop, Verb::replace, Verb::connect_all};
    const std::set leaves{Verb::stop,   Verb::replace, Verb::disconnect, Verb::forget,
                          Verb::change, Verb::connect, Verb::connect_all};
    for (const auto& drone : {step.drone, step.verb == Verb::replace ? step.sender : step.drone}) {
        if (ends.contains(step.verb))
            may_die_.insert(drone);
        if (leaves.contains(step.verb))
            may_leave_.insert(drone);
    }
    silent_ = silent_ || step.verb == Verb::freeze || step.verb == Verb::part;
}

Problems Fates::look(const Statuses& statuses) const
{
    Problems problems;
    for (const auto& [name, status] : statuses)
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges) {
                const auto receiver = edge.receiver.substr(0, edge.receiver.find('.'));
                const auto any = [&](Fate fate) { return edge.events.of(fate) > 0; };
                const bool wrong = (any(Fate::lost_killed) && !may_die_.contains(receiver) && !was_cut_(name, receiver))
                                   || (any(Fate::lost_left) && !may_leave_.contains(receiver))
                                   || (any(Fate::lost_cut_off) && !silent_);
                if (!edge.group && wrong && known_.contains(receiver))
                    problems.push_back("fates: " + name + "." + output.name + " -> " + edge.receiver + ": "
                                       + to_text(edge) + ", without a cause");
            }
    return problems;
}

/// An exception of a group does not name its members.
std::optional<std::string> Fates::came(const Outcome& outcome) const
{
    const auto has_cause = [&](const std::string& drone) {
        return may_die_.contains(drone) || may_leave_.contains(drone) || was_cut_(outcome.sender, drone);
    };
    auto named = outcome.hops;
    std::erase(named, outcome.sender);
    const bool caused =
        has_cause(outcome.sender)
        || (named.empty() ? std::ranges::any_of(known_, has_cause) : std::ranges::any_of(named, has_cause));
    if (!outcome.failed || !outcome.text.starts_with("abandoned") || silent_ || caused)
        return std::nullopt;
    return "fates: event " + std::to_string(outcome.sequence) + " was given up without a cause: " + to_text(outcome);
}

}  // namespace hive::mixtures
