// Queries few drones, and leaves a command unchanged if one does not answer.
#include "cures.hpp"

#include "../match_ports.hpp"

#include <hive/event/clock.hpp>
#include <hive/name.hpp>
#include <hive/remote.hpp>

#include <algorithm>
#include <array>
#include <cctype>

namespace hive::explaining {
namespace {

using What = Cause::What;

constexpr std::size_t max_completed = 4;
constexpr std::size_t max_described = 32;

/// The parameters that name a drone's source or destination.
constexpr std::array<const char*, 3> places{"source", "url", "file"};

/// The connection of the cause.
std::pair<Endpoint, Endpoint> ends_of(const Cause& cause)
{
    const std::string arrow = " -> ";
    const auto at = cause.connection.find(arrow);
    return {parse_endpoint(cause.connection.substr(0, at)), parse_endpoint(cause.connection.substr(at + arrow.size()))};
}

/// The parameter that sets its source, and its value; empty: none.
std::pair<std::string, std::string> source_of(Application& application, const std::string& drone)
{
    const auto interface = application.describe(drone);
    for (const auto* name : places)
        if (interface.parameter(name))
            if (const auto values = application.get(drone, {name}); values.at(name).is_string())
                return {name, values.at(name).get<std::string>()};
    return {};
}

/// What a condition ends with: "credentials=FILE" of "login required; set credentials=FILE". A shell takes it as one
/// word.
std::string setting_in(const std::string& condition)
{
    const std::string_view set = "; set ";
    const auto at = condition.rfind(set);
    const auto setting = at == std::string::npos ? "" : condition.substr(at + set.size());
    const auto equals = setting.find('=');
    if (equals == 0 || equals == std::string::npos || !is_name(setting.substr(0, equals)))
        return "";
    const auto plain = [](unsigned char c) {
        return std::isalnum(c) || std::string_view("_=./-").find(static_cast<char>(c)) != std::string_view::npos;
    };
    return std::ranges::all_of(setting, plain) ? setting : quoted_for_shell(setting);
}

void name_source(Application& application, Cause& cause)
{
    auto [name, value] = source_of(application, cause.drone);
    if (name.empty())
        return;
    cause.evidence += (cause.evidence.empty() ? "" : ", ") + name + "=" + (value.empty() ? "(empty)" : value);
    std::string place = name;
    std::ranges::transform(place, place.begin(), [](unsigned char c) { return std::toupper(c); });
    const auto proposed = setting_in(cause.text);
    cause.command = proposed.empty() && value.starts_with("/dev/")
                        ? "hivectl devices"
                        : "hivectl set " + cause.drone + " " + (proposed.empty() ? name + "=" + place : proposed);
}

using Fit = std::pair<const Port*, const Port*>;

/// The ports of the matching pair, if there is exactly one.
std::optional<std::pair<std::string, std::string>> fit(const Endpoint& sender, const Interface& from,
                                                       const Endpoint& receiver, const Interface& to)
try {
    const auto [output, input] = match_ports(sender, from, receiver, to);
    return std::pair(output->name, input->name);
} catch (const Error&) {
    return std::nullopt;
}

bool receives_nothing(const Status& status) { return status.why == Reason::no_input; }

bool is_source(const Status& status) { return status.inputs.empty(); }

/// The first drone of the swarm that matches as the other end. @param sends  it is to be the sender
std::string other_end(Application& application, const std::string& drone, bool sends)
{
    const auto own = application.describe(drone);
    std::size_t described = 0;
    for (const auto& answer : application.status(application.drones())) {
        const auto* status = value_of(answer.status);
        if (answer.drone == drone || !status || !(sends ? is_source(*status) : receives_nothing(*status))
            || ++described > max_described)
            continue;
        const auto other = application.describe(answer.drone);
        if (sends ? fit({answer.drone, ""}, other, {drone, ""}, own) : fit({drone, ""}, own, {answer.drone, ""}, other))
            return answer.drone;
    }
    return {};
}

void name_sender(Application& application, Cause& cause)
{
    if (const auto sender = other_end(application, cause.drone, true); !sender.empty())
        cause.command = "hivectl connect " + sender + " " + cause.drone;
}

/// hivectl itself receives if no drone can.
void name_receiver(Application& application, Cause& cause)
{
    const auto receiver = other_end(application, cause.drone, false);
    cause.command =
        receiver.empty() ? "hivectl results " + cause.drone : "hivectl connect " + cause.drone + " " + receiver;
}

/// Smaller bodies, if the output can encode them.
void shrink(Application& application, Cause& cause)
{
    const auto [from, to] = ends_of(cause);
    const auto interface = application.describe(from.drone);
    const auto* port = interface.output(from.port);
    cause.command = "hivectl advise " + cause.drone;
    if (port && std::ranges::find(port->encodings, std::string("jpeg"), &Encoding::word) != port->encodings.end())
        cause.command = "hivectl connect " + to_text(from) + " " + to_text(to) + " --encoding jpeg:50";
}

/// A connection that its sender always refuses must be removed.
void withdraw(Application& application, Cause& cause)
{
    const auto [from, to] = ends_of(cause);
    if (!fit(from, application.describe(from.drone), to, application.describe(to.drone)))
        cause.command = "hivectl disconnect " + to_text(from) + " " + to_text(to);
}

/// It throws now, and a few of its failures are kept.
std::optional<KeptFailure> recent_exception(Application& application, const std::string& drone)
{
    constexpr std::int64_t recent_us = 30'000'000;
    auto failures = application.failures(drone);
    const auto found = std::find_if(failures.rbegin(), failures.rend(), [&](const KeptFailure& failure) {
        return failure.run == 0 && failure.time_us >= event::wall_us() - recent_us;
    });
    return found == failures.rend() ? std::nullopt : std::optional(*found);
}

std::optional<KeptFailure> last_crash(Application& application, const std::string& drone)
{
    const auto crashes = application.crashed();
    const auto crash = std::ranges::find(crashes, drone, &CrashedDrone::drone);
    return crash == crashes.end() ? std::nullopt : application.failure_of(*crash);
}

/// The failure of a crash or an exception, if its input is kept here.
void name_failure(Application& application, Cause& cause)
{
    if (const auto failure = cause.what == What::throws ? recent_exception(application, cause.drone)
                                                        : last_crash(application, cause.drone))
        cause.evidence += (cause.evidence.empty() ? "" : "; ") + std::string("its input is kept: hivectl rerun ")
                          + cause.drone + " " + std::to_string(failure->number);
}

/// A stateful drone must be told that its state is lost.
void replace_stateful(Application& application, Cause& cause)
{
    if (cause.command == "hivectl replace " + cause.drone && application.describe(cause.drone).stateful) {
        cause.command += " --lose-state";
        cause.evidence += (cause.evidence.empty() ? "" : "; ") + std::string("its state will be lost");
    }
}

void complete(Application& application, Cause& cause)
try {
    replace_stateful(application, cause);
    switch (cause.what) {
    case What::crashed:
    case What::failed:
    case What::throws: return name_failure(application, cause);
    case What::refused: return cause.connection.empty() ? void() : withdraw(application, cause);
    case What::condition: return name_source(application, cause);
    case What::not_connected: return name_sender(application, cause);
    case What::held:
    case What::no_receiver:
    case What::watched: return cause.command.empty() ? name_receiver(application, cause) : void();
    case What::slow_connection: return shrink(application, cause);
    default: return;
    }
} catch (const Error&) {
    // The drone has just exited or is busy: the command is valid without the details.
}

Cause pair_cause(What what, const Endpoint& receiver, const std::string& text, const std::string& command)
{
    return {.what = what, .drone = receiver.drone, .text = text, .evidence = {}, .command = command};
}

}  // namespace

void complete(Application& application, std::vector<Cause>& causes)
{
    for (std::size_t i = 0; i < std::min(causes.size(), max_completed); ++i)
        complete(application, causes[i]);
}

std::optional<Cause> unconnected_pair(Application& application, const Endpoint& sender, const Endpoint& receiver)
{
    const auto answers = application.status(std::vector{sender.drone, receiver.drone});
    const auto *at_sender = value_of(answers[0].status), *at_receiver = value_of(answers[1].status);
    if (!at_sender || !at_receiver)
        return std::nullopt;
    const auto receives = [](const Status& to, const Status& from, const std::string& port) {
        return std::ranges::any_of(to.inputs, [&](const InputStatus& input) {
            const auto output = parse_endpoint(input.from);
            return output.drone == from.name && (port.empty() || output.port == port);
        });
    };
    if (receives(*at_receiver, *at_sender, sender.port))
        return std::nullopt;
    const auto from = application.describe(sender.drone), to = application.describe(receiver.drone);
    const auto pair = to_text(sender) + " " + to_text(receiver);
    const auto turned = "hivectl connect " + receiver.drone + " " + sender.drone;
    if (receives(*at_sender, *at_receiver, ""))
        return pair_cause(What::wrong_way, receiver,
                          receiver.drone + " sends to " + sender.drone + ", and not " + sender.drone + " to "
                              + receiver.drone,
                          "hivectl explain " + receiver.drone + " " + sender.drone);
    try {
        match_ports(sender, from, receiver, to);
    } catch (const Error& error) {
        if (error.code() == Errc::type_mismatch || error.code() == Errc::not_found)
            return fit({receiver.drone, ""}, to, {sender.drone, ""}, from)
                       ? pair_cause(What::wrong_way, receiver,
                                    std::string(error.what()) + "; the other way round they fit", turned)
                       : pair_cause(What::wrong_types, receiver, error.what(),
                                    "hivectl describe " + sender.drone + " " + receiver.drone);
        if (error.code() != Errc::invalid_argument)
            throw;
        const auto [output, input] = matching_ports(sender, from, receiver, to).front();  // the first of several
        return pair_cause(What::not_connected, receiver, sender.drone + " is not connected to " + receiver.drone,
                          "hivectl connect " + to_text(Endpoint{sender.drone, output->name}) + " "
                              + to_text(Endpoint{receiver.drone, input->name}));
    }
    return pair_cause(What::not_connected, receiver, sender.drone + " is not connected to " + receiver.drone,
                      "hivectl connect " + pair);
}

}  // namespace hive::explaining
