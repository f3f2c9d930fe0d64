// Comparing what was taken from a member with what it has worked on.
#include "lease.hpp"
#include "picture.hpp"

#include <algorithm>
#include <utility>

namespace hive::mixtures {
namespace {

bool works(const Status& status)
{
    return (status.state == State::idle || status.state == State::busy) && status.why != Reason::halted;
}

/// The other end of this edge, if it is there and works.
const InputStatus* member(const Statuses& statuses, const EdgeStatus& edge, const std::string& from)
{
    const auto dot = edge.receiver.find('.');
    const auto found = statuses.find(edge.receiver.substr(0, dot));
    if (edge.group || edge.options.group.empty() || !edge.connected || found == statuses.end() || !works(found->second))
        return nullptr;
    for (const auto& input : found->second.inputs)
        if (input.from == from && input.connected && input.registration == edge.registration)
            return &input;
    return nullptr;
}

/// The sender's is the shortest of its members'.
std::chrono::milliseconds longest_lease(const OutputStatus& output, const std::string& group)
{
    std::chrono::milliseconds longest{};
    for (const auto& edge : output.edges)
        if (!edge.group && edge.options.group == group)
            longest = std::max(longest, edge.options.lease.value_or(std::chrono::minutes(1)));
    return longest;
}

}  // namespace

/// @param now  without what was known before
bool Lease::broken(const std::string& key, Row now)
{
    const auto found = before_.find(key);
    const bool known = found != before_.end() && found->second.registration == now.registration;
    const Row before = known ? found->second : Row{};
    const bool progress = known && now.worked > before.worked;
    const auto at = std::exchange(now.progressed, progress ? looked_ : before.progressed);
    now.emptied = now.emptied || (before.emptied && now.handed_back == before.handed_back);
    rows_[key] = now;
    const bool same = now.handed_back == before.handed_back;
    return same && before.emptied && now.passed_on > before.passed_on && at - before.progressed < short_time;
}

Problems Lease::look(const Statuses& statuses, Time now)
{
    Problems problems;
    for (const auto& [name, status] : statuses)
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges)
                if (const auto* input = member(statuses, edge, name + "." + output.name); input && works(status)) {
                    const Row row{.registration = edge.registration,
                                  .worked = input->processed + input->abandoned + input->duplicates,
                                  .handed_back = input->discarded,
                                  .passed_on = edge.events.of(Fate::passed_on),
                                  .emptied = input->queued + input->in_hand == 0,
                                  .progressed = now};
                    if (broken(name + " " + std::to_string(status.epoch) + " -> " + edge.receiver, row))
                        problems.push_back("lease: " + input->from + " -> " + edge.receiver
                                           + " works, and events were taken from it: the sender has " + to_text(edge)
                                           + "; the receiver has " + to_text(*input));
                }
    before_ = std::exchange(rows_, {});
    looked_ = now;
    return problems;
}

Overdue::Row& Overdue::row(const std::string& registration, std::int64_t finished, Time now, bool followed)
{
    const auto found = before_.find(registration);
    Row row = found != before_.end() ? found->second : Row{};
    if (!followed || found == before_.end() || row.finished != finished)
        row.finished = finished, row.since = now;
    return rows_[registration] = row;
}

Problems Overdue::look(const Statuses& statuses, Time now)
{
    constexpr std::chrono::milliseconds most_between{300}, late{800};
    Problems problems;
    const bool followed = now - std::exchange(looked_, now) < most_between;
    before_ = std::exchange(rows_, {});
    for (const auto& [name, status] : statuses)
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges) {
                const auto* input = member(statuses, edge, name + "." + output.name);
                if (!input)
                    continue;
                const auto held = input->queued + input->in_hand;
                auto& row = this->row(input->from + " -> " + edge.receiver + " " + std::to_string(edge.registration),
                                      input->received - held, now, followed);
                const auto passed_on = edge.events.of(Fate::passed_on);
                if (held == 0)
                    row.since = now, row.passed_on_when_empty = passed_on;
                else if (row.passed_on_when_empty == passed_on
                         && now - row.since > longest_lease(output, edge.options.group) + late)
                    problems.push_back(
                        "lease: " + input->from + " -> " + edge.receiver
                        + " has had events for longer than its lease, and they are not passed on: the sender has "
                        + to_text(edge) + "; the receiver has " + to_text(*input));
            }
    return problems;
}

}  // namespace hive::mixtures
