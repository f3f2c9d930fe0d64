// Sums of ledgers and of intakes, and the two ends of an edge laid side by side.
#include "checks.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

std::string counted(const std::string& name, std::int64_t count) { return name + " " + std::to_string(count); }

std::string words(const EdgeStatus& edge)
{
    std::string text = counted("came", edge.events.total());
    for (std::size_t i = 0; i < fates; ++i)
        if (const auto count = edge.events.of(static_cast<Fate>(i)); count != 0)
            text += ", " + counted(std::string(token(static_cast<Fate>(i))), count);
    return text + ", " + counted("in flight", edge.events.in_flight()) + ", " + counted("waiting", edge.waiting);
}

std::string words(const InputStatus& input)
{
    return counted("received", input.received) + ", " + counted("processed", input.processed) + ", "
           + counted("abandoned", input.abandoned) + ", " + counted("duplicates", input.duplicates) + ", "
           + counted("discarded", input.discarded) + ", " + counted("dropped", input.dropped) + ", "
           + counted("unmatched", input.unmatched) + ", " + counted("queued", input.queued) + ", "
           + counted("in hand", input.in_hand);
}

bool balances(const EdgeStatus& edge, std::int64_t produced)
{
    bool good = edge.events.in_flight() >= 0 && edge.waiting >= 0 && edge.waiting <= edge.events.in_flight();
    for (std::size_t i = 0; i < fates; ++i)
        good = good && edge.events.of(static_cast<Fate>(i)) >= 0;
    return good && (edge.events.total() <= produced || !edge.options.group.empty());  // a member may get one again
}

bool balances(const InputStatus& input)
{
    return input.received
           == input.processed + input.abandoned + input.duplicates + input.discarded + input.dropped + input.unmatched
                  + input.queued + input.in_hand;
}

/// What both ends count of one edge, when both have counted since it was made.
/// @param whole  the receiver has counted all that the sender has sent, and nobody else's
Problems disagreeing(const EdgeStatus& edge, const InputStatus& input, bool whole)
{
    const auto sent = edge.events.total() - edge.waiting - edge.events.of(Fate::skipped) - edge.events.of(Fate::dropped);
    const bool good = input.received <= sent
                      && (!whole || edge.events.of(Fate::acknowledged) <= input.received);
    if (good)
        return {};
    return {input.from + " -> " + edge.receiver + ": the sender has " + words(edge) + "; the receiver has "
            + words(input)};
}

const OutputStatus* output_of(const Statuses& statuses, const std::string& drone)
{
    const auto found = statuses.find(drone);
    if (found == statuses.end())
        return nullptr;
    for (const auto& output : found->second.outputs)
        if (output.name == Topology::output_of(drone))
            return &output;
    return nullptr;
}

}  // namespace

Problems unbalanced(const Statuses& statuses)
{
    Problems problems;
    for (const auto& [name, status] : statuses) {
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges)
                if (!balances(edge, output.produced))
                    problems.push_back("the ledger of " + name + "." + output.name + " -> " + edge.receiver
                                       + " does not balance: " + counted("produced", output.produced) + ", "
                                       + words(edge));
        for (const auto* inputs : {&status.inputs, &status.left})
            for (const auto& input : *inputs)
                if (!balances(input))
                    problems.push_back("the account of " + input.from + " -> " + name + "." + input.input
                                       + " does not balance: " + words(input));
    }
    return problems;
}

Problems disagreeing(const Statuses& statuses)
{
    Problems problems;
    for (const auto& [name, status] : statuses)
        for (const auto& input : status.inputs) {
            const auto sender = input.from.substr(0, input.from.find('.'));
            const auto* output = output_of(statuses, sender);
            if (!output || statuses.at(sender).epoch > status.epoch)
                continue;  // the receiver has counted for an earlier life of the sender as well
            for (const auto& edge : output->edges)
                if (edge.receiver == name + "." + input.input && edge.registration == input.registration)
                    std::ranges::move(disagreeing(edge, input, false), std::back_inserter(problems));
        }
    return problems;
}

bool idle(const Statuses& statuses)
{
    for (const auto& [name, status] : statuses) {
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges)
                if (edge.events.in_flight() != 0)
                    return false;
        for (const auto& input : status.inputs)
            if (input.queued != 0 || input.in_hand != 0)
                return false;
    }
    return true;
}

Json still_picture(const Statuses& statuses)
{
    Json picture = Json::object();
    for (auto [name, status] : statuses) {
        status.uptime_us = status.busy_us = status.busy_for_us = 0;
        status.state = State::idle;
        status.callback.clear();
        for (auto& input : status.inputs)
            input.last_age_us = 0;
        picture[name] = to_json(status);
    }
    return picture;
}

bool says_why(const Status& status)
{
    return status.why != Reason::none || std::ranges::any_of(status.outputs, [](const OutputStatus& output) {
               return output.why != Reason::none
                      || std::ranges::any_of(output.edges, [](auto& edge) { return edge.why != Reason::none; });
           });
}

Problems without_reason(const Statuses& statuses)
{
    Problems problems;
    for (const auto& [name, status] : statuses)
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges)
                if (edge.events.in_flight() != 0 && edge.why == Reason::none && output.why == Reason::none
                    && status.why == Reason::none)
                    problems.push_back(name + "." + output.name + " -> " + edge.receiver
                                       + " stands still without a reason: " + words(edge));
    return problems;
}

bool connected(const Statuses& statuses, const Edge& edge)
{
    const auto* output = output_of(statuses, edge.sender);
    const auto receiver = statuses.find(edge.receiver);
    if (!output || receiver == statuses.end())
        return false;
    const auto from = edge.sender + "." + output->name;
    return std::ranges::any_of(receiver->second.inputs, [&](auto& input) { return input.from == from && input.connected; })
           && std::ranges::any_of(output->edges, [&](auto& row) {
                  return row.connected && row.receiver.substr(0, row.receiver.find('.')) == edge.receiver;
              });
}

}  // namespace hive::mixtures
