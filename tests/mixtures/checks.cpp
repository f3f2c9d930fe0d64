// Sums of ledgers and of intakes, and the two ends of an edge laid side by side.
#include "checks.hpp"
#include "picture.hpp"

#include <algorithm>

namespace hive::mixtures {
namespace {

bool balances(const EdgeStatus& edge, std::int64_t produced)
{
    bool good = edge.events.in_flight() >= 0 && edge.waiting >= 0 && edge.waiting <= edge.events.in_flight();
    for (std::size_t i = 0; i < fates; ++i)
        good = good && edge.events.of(static_cast<Fate>(i)) >= 0;
    // A member may get an event again, and an application may have several places.
    const bool once_each = edge.options.group.empty() && edge.receiver.find('.') != std::string::npos;
    const auto taken_along = edge.events.of(Fate::passed_on);  // to another group, from where it may be back
    return good && (edge.events.total() - taken_along <= produced || !once_each);
}

bool balances(const InputStatus& input)
{
    const bool negative = input.queued < 0 || input.in_hand < 0;
    return !negative
           && input.received
                  == input.processed + input.abandoned + input.duplicates + input.discarded + input.dropped
                         + input.unmatched + input.queued + input.in_hand;
}

bool has_losses(const Ledger& events)
{
    for (std::size_t i = 0; i < fates; ++i)
        if (is_loss(static_cast<Fate>(i)) && events.of(static_cast<Fate>(i)) > 0)
            return true;
    return false;
}

/// What one end has counted while the other one was there as well.
struct Ages {
    bool sender_older = false, receiver_older = false;
};

/// @param left  what the receiver got through connections that were ended since
Problems disagreeing(const EdgeStatus& edge, const InputStatus& input, std::int64_t left, Ages ages)
{
    const auto unsent = edge.waiting + edge.events.of(Fate::skipped) + edge.events.of(Fate::dropped);
    const bool made_up = ages.sender_older && input.received - input.duplicates > edge.events.total() - unsent;
    const bool lost = ages.receiver_older && edge.events.of(Fate::acknowledged) > input.received + left;
    if (!made_up && !lost)
        return {};
    return {"both ends: " + input.from + " -> " + edge.receiver + ": the sender has " + to_text(edge)
            + "; the receiver has " + to_text(input)};
}

bool waits_for_partners(const Statuses& statuses, const std::string& drone)
{
    const auto found = statuses.find(drone);
    return found != statuses.end() && std::ranges::any_of(found->second.matching, &MatchingStatus::waiting);
}

std::int64_t received_before(const Status& status, const std::string& input)
{
    std::int64_t received = 0;
    for (const auto& row : status.left)
        received += row.input == input ? row.received : 0;
    return received;
}

/// @param from  "face.result"
const OutputStatus* output_of(const Statuses& statuses, const std::string& from)
{
    const auto dot = from.find('.');
    const auto found = statuses.find(from.substr(0, dot));
    if (found == statuses.end())
        return nullptr;
    const auto output = std::ranges::find(found->second.outputs, from.substr(dot + 1), &OutputStatus::name);
    return output == found->second.outputs.end() ? nullptr : &*output;
}

bool is_collector(const EdgeStatus& edge)
{
    return edge.connected && !edge.group && edge.receiver.find('.') == std::string::npos;
}

std::string main_output(const std::string& drone) { return drone + "." + Topology::output_of(drone); }

/// Does the receiver say why it does not acknowledge what comes from there? If it waits for its own receivers, that is
/// a question for those edges.
bool explains(const Status& receiver, const std::string& from)
{
    return receiver.why != Reason::none || std::ranges::any_of(receiver.matching, &MatchingStatus::waiting)
           || std::ranges::any_of(receiver.inputs,
                                  [&](auto& input) { return input.from == from && input.why != Reason::none; })
           || std::ranges::any_of(receiver.outputs, [](auto& output) {
                  return std::ranges::any_of(output.edges, [](auto& edge) { return edge.events.in_flight() != 0; });
              });
}

/// The other end of this edge, if it answers.
const InputStatus* input_of(const Statuses& statuses, const EdgeStatus& edge, const std::string& from)
{
    const auto found = statuses.find(edge.receiver.substr(0, edge.receiver.find('.')));
    if (found == statuses.end())
        return nullptr;
    const auto input = std::ranges::find_if(found->second.inputs, [&](const InputStatus& each) {
        return each.from == from && each.registration == edge.registration;
    });
    return input == found->second.inputs.end() ? nullptr : &*input;
}

/// Has it anything in hand, or do its results wait, so that it asks for nothing?
bool is_busy(const Status& status)
{
    const auto in_flight = [](const EdgeStatus& edge) { return edge.events.in_flight() != 0; };
    return std::ranges::any_of(status.inputs, [](auto& input) { return input.queued + input.in_hand > 0; })
           || std::ranges::any_of(status.left, [](auto& input) { return input.queued + input.in_hand > 0; })
           || std::ranges::any_of(status.outputs,
                                  [&](auto& output) { return std::ranges::any_of(output.edges, in_flight); });
}

/// May its reason be why no event moves on this edge?
bool is_true(const EdgeStatus& edge, const OutputStatus& output, const Status* receiver, const InputStatus* input)
{
    switch (edge.why) {
    case Reason::not_asked:
    case Reason::not_acknowledged: return !input || is_busy(*receiver) || receiver->why != Reason::none;
    case Reason::place_kept: return !edge.connected && !(input && input->connected);
    case Reason::lane_full: return !receiver;  // a running receiver reads
    case Reason::group_awaited:
        return std::ranges::none_of(output.edges, [&](const EdgeStatus& other) {
            return !other.group && other.connected && other.options.group == edge.options.group;
        });
    default: return true;
    }
}

std::string listed(const std::set<std::string>& names)
{
    std::string text;
    for (const auto& name : names)
        text += (text.empty() ? "" : ", ") + name;
    return text.empty() ? "nobody" : text;
}

}  // namespace

Problems unbalanced(const Statuses& statuses)
{
    Problems problems;
    for (const auto& [name, status] : statuses) {
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges)
                if (!balances(edge, output.produced))
                    problems.push_back("ledger: that of " + name + "." + output.name + " -> " + edge.receiver
                                       + " does not balance: " + "produced " + std::to_string(output.produced) + ", "
                                       + to_text(edge));
        for (const auto* inputs : {&status.inputs, &status.left})
            for (const auto& input : *inputs)
                if (!balances(input))
                    problems.push_back("ledger: the account of " + input.from + " -> " + name + "." + input.input
                                       + " does not balance: " + to_text(input));
    }
    return problems;
}

Problems contradictory(const Statuses& statuses)
{
    Problems problems;
    const auto add = [&](const std::string& what) { problems.push_back("status: " + what); };
    for (const auto& [name, status] : statuses) {
        if (status.state == State::halted ? !status.halted : status.state == State::idle && status.halted)
            add(name + " is " + std::string(token(status.state)) + ", and has " + (status.halted ? "" : "not ")
                + "halted");
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges)
                if ((edge.group || edge.options.group.empty())  // a member's losses are its group's
                    && has_losses(edge.events) != (edge.last_lost_us > 0))
                    add(name + "." + output.name + " -> " + edge.receiver + ": losses and the time of the newest");
        for (const auto* inputs : {&status.inputs, &status.left})
            for (const auto& input : *inputs) {
                if (input.connected && input.registration == 0)
                    add(input.from + " -> " + name + "." + input.input + " is connected, and not since when");
                if ((input.abandoned + input.dropped > 0) != (input.last_lost_us > 0))
                    add(input.from + " -> " + name + "." + input.input + ": losses and the time of the newest");
            }
    }
    return problems;
}

Problems disagreeing(const Statuses& statuses, const std::map<std::string, int>& born)
{
    Problems problems;
    for (const auto& [name, status] : statuses)
        for (const auto& input : status.inputs) {
            const auto sender = input.from.substr(0, input.from.find('.'));
            const auto* output = output_of(statuses, input.from);
            if (!output || !input.connected || input.registration == 0)
                continue;
            const Ages ages{.sender_older = born.at(sender) <= born.at(name),
                            .receiver_older = born.at(name) <= born.at(sender)};
            for (const auto& edge : output->edges)
                if (edge.receiver == name + "." + input.input && edge.registration == input.registration)
                    std::ranges::move(disagreeing(edge, input, received_before(status, input.input), ages),
                                      std::back_inserter(problems));
        }
    return problems;
}

bool idle(const Statuses& statuses, bool but_for_partners)
{
    const auto left_out = [&](const std::string& receiver) {
        return but_for_partners && waits_for_partners(statuses, receiver.substr(0, receiver.find('.')));
    };
    for (const auto& [name, status] : statuses) {
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges)
                if (edge.events.in_flight() != 0 && !left_out(edge.receiver))
                    return false;
        for (const auto& input : status.inputs)
            if ((input.queued != 0 || input.in_hand != 0) && !left_out(name))
                return false;
    }
    return true;
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
            for (const auto& edge : output.edges) {
                const auto receiver = statuses.find(edge.receiver.substr(0, edge.receiver.find('.')));
                const bool answers = receiver != statuses.end();
                if ((edge.waiting != 0 || answers) && edge.events.in_flight() != 0 && edge.why == Reason::none
                    && output.why == Reason::none && status.why == Reason::none
                    && !(answers && explains(receiver->second, name + "." + output.name)))
                    problems.push_back("why: " + name + "." + output.name + " -> " + edge.receiver
                                       + " stands still without a reason: " + to_text(edge));
            }
    return problems;
}

Problems with_false_reason(const Statuses& statuses)
{
    Problems problems;
    for (const auto& [name, status] : statuses)
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges) {
                const auto* input = input_of(statuses, edge, name + "." + output.name);
                const auto receiver = statuses.find(edge.receiver.substr(0, edge.receiver.find('.')));
                if (!is_true(edge, output, receiver == statuses.end() ? nullptr : &receiver->second, input))
                    problems.push_back("why: " + name + "." + output.name + " -> " + edge.receiver
                                       + " gives a reason that is not true: " + to_text(edge)
                                       + (input ? "; the receiver has " + to_text(*input) : ""));
            }
    return problems;
}

Problems wrongly_connected(const Statuses& statuses, const std::set<std::pair<std::string, std::string>>& wanted)
{
    Problems problems;
    for (const auto& [name, status] : statuses) {
        std::set<std::string> senders, present;
        for (const auto& [sender, receiver] : wanted)
            if (receiver == name)
                senders.insert(sender);
        for (const auto& input : status.inputs)
            present.insert(input.from.substr(0, input.from.find('.')));
        if (present != senders)
            problems.push_back("restored: " + name + " was told to receive from " + listed(senders)
                               + ", and its status has " + listed(present));
    }
    return problems;
}

Problems wrongly_resumed(const Statuses& statuses, const std::set<std::string>& halted)
{
    Problems problems;
    for (const auto& name : halted)
        if (const auto found = statuses.find(name);
            found != statuses.end() && found->second.state != State::halted && found->second.why != Reason::halted)
            problems.push_back("restored: " + name + " had halted, and goes on");
    return problems;
}

bool connected(const Statuses& statuses, const Edge& edge)
{
    const auto from = main_output(edge.sender);
    const auto* output = output_of(statuses, from);
    const auto receiver = statuses.find(edge.receiver);
    if (!output || receiver == statuses.end())
        return false;
    return std::ranges::any_of(receiver->second.inputs,
                               [&](auto& input) { return input.from == from && input.connected; })
           && std::ranges::any_of(output->edges, [&](auto& row) {
                  return row.connected && row.receiver.substr(0, row.receiver.find('.')) == edge.receiver;
              });
}

std::int64_t collectors_of(const Statuses& statuses, const std::string& drone)
{
    const auto* output = output_of(statuses, main_output(drone));
    return !output ? 0 : std::ranges::count_if(output->edges, is_collector);
}

bool all_collected(const Statuses& statuses, const std::string& drone)
{
    const auto found = statuses.find(drone);
    return found != statuses.end() && std::ranges::all_of(found->second.outputs, [](const OutputStatus& output) {
               return output.name == "exceptions" || std::ranges::any_of(output.edges, is_collector);
           });
}

std::int64_t unheard(const Statuses& statuses)
{
    std::int64_t count = 0;
    for (const auto& [name, status] : statuses)
        for (const auto& output : status.outputs)
            if (output.name == "exceptions") {
                count += output.produced;
                for (const auto& edge : output.edges)
                    if (edge.receiver == hearer)
                        count -= edge.events.of(Fate::acknowledged);
            }
    return count;
}

bool heard(const Statuses& statuses, const std::string& drone)
{
    const auto found = statuses.find(drone);
    return found != statuses.end() && std::ranges::any_of(found->second.outputs, [](const OutputStatus& output) {
               return output.name == "exceptions" && std::ranges::any_of(output.edges, [](auto& edge) {
                          return edge.connected && edge.receiver == hearer;
                      });
           });
}

}  // namespace hive::mixtures
