// Connects by sending each receiver the output at which it is to register, and its addresses; to all at once.
#include "application_core.hpp"
#include "match_ports.hpp"

#include <hive/name.hpp>
#include <hive/protocol/requests.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace hive {

using protocol::PacketType;

std::string to_text(const Endpoint& end) { return end.port.empty() ? end.drone : end.drone + "." + end.port; }

Endpoint parse_endpoint(std::string_view text)
{
    const auto dot = std::min(text.rfind('.'), text.size());
    return {std::string(text.substr(0, dot)), std::string(text.substr(std::min(dot + 1, text.size())))};
}

std::pair<Endpoint, Endpoint> Application::connect(const Endpoint& sender, const Endpoint& receiver,
                                                   const ConnectionOptions& options)
{
    const auto made = connect({{sender, receiver, options}}).front();
    if (made.error)
        throw *made.error;
    return {made.sender, made.receiver};
}

std::vector<ConnectAnswer> Application::connect(const std::vector<SwarmConnection>& connections)
{
    return core_->connect(connections);
}

namespace {

constexpr std::string_view on_network = "tcp://";

/// The directory of its socket, among the places that a drone reports; empty: not reported.
std::string home_in(const std::vector<std::string>& places)
{
    for (const auto& place : places)
        if (place.starts_with("unix:"))
            return place.substr(0, place.rfind('/'));
    return {};
}

/// A drone elsewhere that listens at all addresses of its machine is reachable at the host at which we reach it. For
/// one on this machine the address is left open: the receiver sees which of our addresses it reaches, that from which
/// it gets the request.
std::string seen_from_here(const std::string& address, const Place& place)
{
    auto parsed = transport::parse_address(address);
    if (!is_here(place) && parsed.is_everywhere())
        parsed.host = transport::parse_address(place.address).host;
    return to_text(parsed);
}

using Answers = std::map<std::string, Answer>;

/// Throws the error that the drone answers.
const Json& answer_of(const Answers& answers, const std::string& drone)
{
    return value_or_throw(answers.at(drone).result);
}

/// Addresses at which the receiver can reach the sender, the nearest first; an empty one: by name in the receiver's
/// home.
/// @param from, to  addresses that the two report
std::vector<std::string> ways(const Place& sender, const std::vector<std::string>& from, const Place& receiver,
                              const std::vector<std::string>& to)
{
    std::vector<std::string> ways;
    const auto add = [&](const std::string& way) {
        if (std::ranges::find(ways, way) == ways.end())
            ways.push_back(way);
    };
    if (sender.host == receiver.host && home_in(from) == home_in(to))
        add("");
    for (const auto& address : from)
        if (address.starts_with(on_network))
            add(seen_from_here(address, sender));
    if (!is_here(sender))
        add(sender.address);
    if (ways.empty())
        throw Error(Errc::unreachable,
                    sender.drone + " does not listen on the network, so " + receiver.drone + " at " + receiver.host
                        + " cannot reach it",
                    "start it with --listen tcp://HOST");
    return ways;
}

}  // namespace

/// A request to connect, and the addresses of the sender that the receiver tries in turn.
struct Application::Core::Wire {
    std::size_t row;  ///< of its connection
    std::string receiver;
    protocol::Connect request;
    std::vector<std::string> ways;
};

std::vector<ConnectAnswer> Application::Core::connect(const std::vector<SwarmConnection>& connections)
{
    std::set<std::string> drones;
    for (const auto& connection : connections)
        drones.insert({connection.from.drone, connection.to.drone});
    const auto query = [&](PacketType type, const Json& header) {
        Answers answers;
        for (auto& answer : ask_all({drones.begin(), drones.end()}, type, header))
            answers.emplace(answer.drone, std::move(answer));
        return answers;
    };
    const auto interfaces = query(PacketType::describe, Json::object());
    const bool all_here = std::ranges::all_of(drones, [&](const std::string& drone) {
        const auto found = place_or_error(drone);
        const auto* place = std::get_if<Place>(&found);
        return !place || is_here(*place);
    });
    const auto statuses = all_here ? Answers() : query(PacketType::status, {{"skip", max_json_integer}});

    std::vector<ConnectAnswer> made;
    std::vector<Wire> wires;
    for (const auto& [sender, receiver, options] : connections)
        try {
            made.push_back({sender, receiver, std::nullopt});
            const auto from = interface_from_json(answer_of(interfaces, sender.drone)),
                       to = interface_from_json(answer_of(interfaces, receiver.drone));
            const auto [output, input] = match_ports(sender, from, receiver, to);
            if (to.stateful && !options.group.empty())
                throw sharing_refused(receiver.drone);
            made.back().sender.port = output->name;
            made.back().receiver.port = input->name;
            const auto place_of_sender = place(sender.drone), place_of_receiver = place(receiver.drone);
            const auto places_of = [&](const Endpoint& end) {
                return status_from_json(answer_of(statuses, end.drone)).places;
            };
            wires.push_back(
                {made.size() - 1,
                 receiver.drone,
                 {.drone = place_of_sender.drone, .output = output->name, .input = input->name, .options = options},
                 is_here(place_of_sender) && is_here(place_of_receiver)
                     ? std::vector<std::string>{""}
                     : ways(place_of_sender, places_of(sender), place_of_receiver, places_of(receiver))});
        } catch (const Error& error) {
            made.back().error = error;
        }
    connect(std::move(wires), made);
    return made;
}

/// Each address has its share of the timeout, but not less than an attempt needs.
void Application::Core::connect(std::vector<Wire> wires, std::vector<ConnectAnswer>& made)
{
    constexpr std::chrono::milliseconds usual_time(5000);
    const auto until = deadline();
    for (std::size_t tried = 0; !wires.empty(); ++tried) {
        std::vector<std::string> receivers;
        std::vector<Json> requests;
        for (auto& wire : wires) {
            wire.request.address = wire.ways[tried];
            receivers.push_back(wire.receiver);
            requests.push_back(to_json(wire.request));
        }
        const auto answers = ask_all(receivers, PacketType::connect, requests, [&](std::size_t i) {
            const auto now = event::Clock::now();
            const auto share = (until - now) / static_cast<int>(wires[i].ways.size() - tried);
            return now + std::max<event::Clock::duration>(share, std::min(timeout, usual_time));
        });
        std::vector<Wire> again;
        for (std::size_t i = 0; i < wires.size(); ++i) {
            const auto* error = error_of(answers[i].result);
            if (error && (error->code() == Errc::unreachable || error->code() == Errc::timeout)
                && tried + 1 < wires[i].ways.size())
                again.push_back(std::move(wires[i]));
            else if (error)
                made[wires[i].row].error = *error;
        }
        wires = std::move(again);
    }
}

void Application::Core::forget(const Endpoint& sender, const Endpoint& receiver)
{
    const std::string name = drone_of(receiver.drone) + (receiver.port.empty() ? "" : "." + receiver.port);
    ask(sender.drone, PacketType::forget, to_json(protocol::Forget{.output = sender.port, .receiver = name}));
}

void Application::disconnect(const Endpoint& sender, const Endpoint& receiver)
{
    require_name(drone_of(receiver.drone), "drone");
    std::optional<Error> refused;
    try {
        if (core_->directory.find(receiver.drone))
            return core_->disconnect(sender, receiver);
    } catch (const Error& error) {
        // From here the receiver seems to be gone, or it hangs, or was never connected.
        const bool gone = error.code() == Errc::unreachable && !is_here(core_->place(receiver.drone));
        if (!gone && error.code() != Errc::not_found && error.code() != Errc::timeout)
            throw;
        refused = error;
    }
    try {
        core_->forget(sender, receiver);
    } catch (const Error& error) {
        if (refused)
            throw *refused;
        if (error.code() != Errc::not_found)
            throw;
        throw core_->not_running(receiver.drone).reworded(receiver.drone + " is not running, and " + error.what());
    }
}

void Application::Core::disconnect(const Endpoint& sender, const Endpoint& receiver)
{
    const protocol::Disconnect what{.drone = drone_of(sender.drone), .output = sender.port, .input = receiver.port};
    ask(receiver.drone, PacketType::disconnect, to_json(what));
}

}  // namespace hive
