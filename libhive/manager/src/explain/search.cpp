// Walks upstream from the drones in question, and then to the receivers for which these wait.
#include "../directory.hpp"
#include "search.hpp"

#include <hive/duration_text.hpp>
#include <hive/stall.hpp>

#include <algorithm>

namespace hive::explaining {
namespace {

constexpr auto exceptions = "exceptions";

/// Does it include this port?
bool is_meant(const OutputStatus& output, const std::string& port)
{
    return port.empty() ? output.name != exceptions : output.name == port;
}

/// Receivers that connected with the viewers' key, for bodies.
bool has_viewers(const OutputStatus& output)
{
    return std::ranges::any_of(output.edges, [](const EdgeStatus& edge) {
        return edge.connected && edge.options.delivery == Delivery::data && edge.receiver.ends_with(" (viewer)");
    });
}

bool is_from(const InputStatus& input, const Endpoint& sender)
{
    return sender.port.empty() ? parse_endpoint(input.from).drone == hive::drone_of(sender.drone)
                               : input.from == hive::drone_of(sender.drone) + "." + sender.port;
}

}  // namespace

std::int64_t processed(const Status& status, std::int64_t InputStatus::*count)
{
    std::int64_t sum = 0;
    for (const auto* rows : {&status.inputs, &status.left})
        for (const auto& input : *rows)
            sum += input.*count;
    return sum;
}

std::int64_t quiet_us(const Status& status, const OutputStatus& output)
{
    return status.epoch + status.uptime_us - std::max(status.epoch, output.last_emitted_us);
}

std::int64_t emitted(const Status& status)
{
    std::int64_t sum = 0;
    for (const auto& output : status.outputs)
        if (output.name != exceptions)
            sum += output.produced;
    return sum;
}

void Search::target(const std::string& drone, const std::string& port)
{
    const auto* answer = look_.find(drone);
    if (above(drone) || !answer || error_of(answer->status))
        return;
    const auto found = causes_.size();
    outputs(*answer, port);
    if (causes_.size() == found)
        quiet(*answer, port);
    if (causes_.size() == found)
        unreceived(*answer);
}

void Search::connection(const Endpoint& sender, const Endpoint& receiver)
{
    const auto* answer = look_.find(receiver.drone);
    if (!answer)
        return;
    above(receiver.drone, &sender);
    if (error_of(answer->status))
        return;
    const auto* from = look_.find(sender.drone);
    if (from && value_of(from->status) && causes_.empty())
        quiet(*from, sender.port);
}

bool Search::above(const std::string& drone, const Endpoint* only, const std::string& evidence)
{
    const auto found = causes_.size();
    const auto* answer = look_.find(drone);
    if (!answer || !seen_.insert(answer->drone).second)
        return false;
    const auto* status = value_of(answer->status);
    if (!status) {
        if (const auto senders = look_.saved_senders.find(answer->drone); senders != look_.saved_senders.end())
            for (const auto& sender : senders->second)
                above(sender);
        silent(*answer, evidence);
        return true;
    }
    for (const auto& input : status->inputs)
        if (!only || is_from(input, *only))
            link(*answer, input);
    passed_.push_back(answer->drone);
    if (!own(*answer) && status->why == Reason::backlog)
        outputs(*answer, "");
    return causes_.size() > found;
}

void Search::link(const StatusAnswer& receiver, const InputStatus& input)
{
    const auto* sender = look_.find(parse_endpoint(input.from).drone);
    const auto port = parse_endpoint(input.from).port;
    const auto found = causes_.size();
    const auto* error = sender ? error_of(sender->status) : nullptr;
    // This machine need not know a drone that the receiver knows.
    const bool unknown =
        !sender || (error && error->code() == Errc::not_found && (input.connected || is_elsewhere(receiver.place)));
    if (!unknown && error) {
        above(sender->drone, nullptr, receiver.drone + "." + input.input + " receives from it");
        return;
    }
    if (!unknown) {
        above(sender->drone);
        if (causes_.size() == found)
            outputs(*sender, port);
    }
    if (causes_.size() == found)
        unconnected(receiver, input);
    if (causes_.size() == found && !unknown)
        quiet(*sender, port);
    if (causes_.size() == found && !unknown) {
        narrow(receiver, input);
        encoded(receiver, input);
        dropping(receiver, input);
        copied(receiver, input);
    }
}

bool Search::outputs(const StatusAnswer& answer, const std::string& port)
{
    const auto& status = std::get<Status>(answer.status);
    bool explained = false;
    for (const auto& output : status.outputs)
        if (is_meant(output, port) && stalls(status, output))
            explained |= waits(answer, output);
    return explained;
}

bool Search::waits(const StatusAnswer& answer, const OutputStatus& output)
{
    const auto end = answer.drone + "." + output.name;
    const auto since = "nothing for " + duration_text(quiet_us(std::get<Status>(answer.status), output));
    if (output.why == Reason::held)
        add(Cause::What::held, answer.drone, "lossless events of " + end + " wait for a receiver of bodies", since);
    else if (output.why == Reason::no_receiver)
        add(Cause::What::no_receiver, answer.drone, end + " has no receivers", since);
    else if (output.why == Reason::watched && has_viewers(output))
        add(Cause::What::watched, answer.drone,
            "only viewers receive " + end + ", and on demand it waits for a receiver with the members' key", since,
            "hivectl key show");
    else if (output.why == Reason::watched)
        add(Cause::What::watched, answer.drone,
            "only headers of " + end + " are received, and on demand it waits for a receiver of bodies", since);
    else
        return below(answer, output);
    return true;
}

bool Search::below(const StatusAnswer& sender, const OutputStatus& output)
{
    bool explained = false;
    for (const auto* edge : awaited(output))
        explained |= below(sender, output, *edge);
    return explained;
}

bool Search::below(const StatusAnswer& sender, const OutputStatus& output, const EdgeStatus& edge)
{
    const auto* answer = look_.find(parse_endpoint(edge.receiver).drone);
    const auto* error = answer ? error_of(answer->status) : nullptr;
    const bool missing = !answer || (error && error->code() == Errc::not_found);
    if (edge.receiver == self_)
        return false;
    const auto [explained, is_first] = waited_for_.try_emplace(answer ? answer->drone : edge.receiver, false);
    if (!is_first)
        return explained->second;  // false in a cycle, which is examined now
    const Wait wait{sender.drone + "." + output.name, edge, quiet_us(std::get<Status>(sender.status), output)};
    if (missing)
        missing_receiver(sender, wait);
    else if (error)
        silent(*answer, wait.text());
    else if (!own(*answer, edge.connected) && !outputs(*answer, ""))
        receiver(*answer, wait);
    return explained->second = true;
}

/// The receiver of a sender on another machine is known here only if it was on this one.
bool Search::may_be_started(const std::string& drone, const StatusAnswer& sender) const
{
    return !start_of(drone).command.empty() && (!is_elsewhere(sender.place) || absent_.remembered.contains(drone));
}

void Search::missing_receiver(const StatusAnswer& sender, const Wait& wait)
{
    const auto drone = parse_endpoint(wait.edge.receiver).drone;
    if (wait.edge.connected)  // an application, or a drone that only its sender knows
        add(Cause::What::waits, sender.drone, wait.edge.receiver + " does not request more events of " + wait.end,
            wait.text(), "hivectl disconnect " + wait.end + " " + wait.edge.receiver);
    else if (may_be_started(drone, sender))
        not_running(drone, "", wait.text());
    else
        add(Cause::What::receiver_away, drone, wait.edge.receiver + " is away, and " + wait.end + " waits for it",
            wait.text(), "hivectl disconnect " + wait.end + " " + wait.edge.receiver);
}

/// For a running receiver that reports no cause.
void Search::receiver(const StatusAnswer& answer, const Wait& wait)
{
    auto& cause = receiver_cause(answer, wait);
    cause.connection = wait.end + " -> " + wait.edge.receiver;
}

/// An idle receiver on another machine has not got yet what was sent to it.
bool Search::is_under_way(const StatusAnswer& receiver, const EdgeStatus& edge)
{
    const auto awaits = [&](const InputStatus& input) {
        return input.registration == edge.registration && !input.address.empty() && input.queued + input.in_hand == 0;
    };
    const auto& status = std::get<Status>(receiver.status);
    return edge.events.in_flight() > edge.waiting && status.state == State::idle
           && std::ranges::any_of(status.inputs, awaits);
}

Cause& Search::receiver_cause(const StatusAnswer& answer, const Wait& wait)
{
    if (!wait.edge.connected)
        return add(Cause::What::receiver_away, answer.drone,
                   wait.edge.receiver + " is not connected to " + wait.end + " now", wait.text(),
                   "hivectl connect " + wait.end + " " + wait.edge.receiver);
    if (wait.edge.why == Reason::lane_full || is_under_way(answer, wait.edge))
        return add(Cause::What::slow_connection, answer.drone,
                   "the connection takes events more slowly than " + wait.end + " makes them", wait.text());
    if (wait.edge.why == Reason::not_asked && std::get<Status>(answer.status).state == State::busy)
        return slow(answer, wait.text());
    return add(Cause::What::waits, answer.drone,
               wait.end + " waits for " + wait.edge.receiver + ": " + std::string(sentence(wait.edge.why)), wait.text(),
               "hivectl replace " + answer.drone);
}

std::string Search::Wait::text() const
{
    return end + " has sent nothing for " + duration_text(quiet) + " and waits for " + edge.receiver;
}

}  // namespace hive::explaining
