// Members that could work, beside what waits for their group.
#include "idle.hpp"
#include "picture.hpp"

#include <algorithm>
#include <utility>

namespace hive::mixtures {
namespace {

bool waits(const OutputStatus& output, const std::string& group)
{
    return std::ranges::any_of(output.edges, [&](const EdgeStatus& edge) {
        return edge.group && edge.options.group == group && edge.waiting > 0;
    });
}

/// A member that still owes an answer may not be given the same event again.
bool has_nothing(const Status& member, const EdgeStatus& edge, const std::string& from)
{
    if (member.state != State::idle || member.why != Reason::none)
        return false;
    for (const auto& output : member.outputs)
        for (const auto& result : output.edges)
            if (result.events.in_flight() != 0)
                return false;
    return std::ranges::any_of(member.inputs, [&](const InputStatus& input) {
        return input.from == from && input.connected && input.registration == edge.registration
               && input.queued + input.in_hand == 0;
    });
}

}  // namespace

Problems Idle::look(const Statuses& statuses, Time now)
{
    Problems problems;
    const auto before = std::exchange(since_, {});
    const bool followed = now - std::exchange(looked_, now) < limit_;
    const auto look_at = [&](const std::string& output, const EdgeStatus& edge) {
        const auto key = output + " -> " + edge.receiver + " " + std::to_string(edge.registration);
        const auto found = before.find(key);
        const auto since = since_[key] = followed && found != before.end() ? found->second : now;
        if (now - since > limit_)
            problems.push_back("idle: " + output + " -> " + edge.receiver
                               + " has asked and has nothing to do, and events wait for its group: " + to_text(edge));
    };
    for (const auto& [name, status] : statuses)
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges) {
                const auto member = statuses.find(edge.receiver.substr(0, edge.receiver.find('.')));
                const auto from = name + "." + output.name;
                if (!edge.group && edge.connected && edge.why == Reason::none && member != statuses.end()
                    && waits(output, edge.options.group) && has_nothing(member->second, edge, from))
                    look_at(from, edge);
            }
    return problems;
}

}  // namespace hive::mixtures
