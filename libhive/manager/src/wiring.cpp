// Connects by sending the receiver the output at which it is to register, and its addresses.
#include "application_core.hpp"
#include "fitting_ports.hpp"

#include <hive/name.hpp>
#include <hive/protocol/requests.hpp>

#include <algorithm>

namespace hive {

using protocol::PacketType;

std::string to_text(const Endpoint& end) { return end.port.empty() ? end.drone : end.drone + "." + end.port; }

/// Each address has its share of the timeout, but not less than an attempt needs.
std::pair<Endpoint, Endpoint> Application::connect(const Endpoint& sender, const Endpoint& receiver,
                                                   const ConnectionOptions& options)
{
    const auto from = describe(sender.drone), to = describe(receiver.drone);
    const auto [output, input] = fitting_ports(sender, from, receiver, to);
    if (to.stateful && !options.group.empty())
        throw sharing_refused(receiver.drone);
    const auto place = core_->place(sender.drone);
    protocol::Connect request{.drone = place.drone, .output = output->name, .input = input->name, .options = options};
    const auto ways = core_->ways(sender.drone, receiver.drone);
    constexpr std::chrono::milliseconds usual_time(5000);
    const auto until = core_->deadline();
    for (std::size_t i = 0; i < ways.size(); ++i)
        try {
            request.address = ways[i];
            const auto now = event::Clock::now();
            const auto share = (until - now) / static_cast<int>(ways.size() - i);
            core_->ask(receiver.drone, PacketType::connect, to_json(request), {},
                       now + std::max<event::Clock::duration>(share, std::min(core_->timeout, usual_time)));
            break;
        } catch (const Error& error) {
            if (i + 1 == ways.size() || (error.code() != Errc::unreachable && error.code() != Errc::timeout))
                throw;
        }
    return {{sender.drone, output->name}, {receiver.drone, input->name}};
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
    if (!is_here(place) && (parsed.host == "0.0.0.0" || parsed.host == "::"))
        parsed.host = transport::parse_address(place.address).host;
    return to_text(parsed);
}

}  // namespace

std::vector<std::string> Application::Core::ways(const std::string& from, const std::string& to)
{
    const auto sender = place(from), receiver = place(to);
    if (is_here(sender) && is_here(receiver))
        return {""};
    const auto answers = ask_all({from, to}, PacketType::status, Json{{"skip", max_json_integer}});
    std::vector<std::vector<std::string>> places;
    for (const auto& answer : answers) {
        if (answer.error)
            throw *answer.error;
        places.push_back(status_from_json(answer.result).places);
    }
    std::vector<std::string> ways;
    const auto add = [&](const std::string& way) {
        if (std::ranges::find(ways, way) == ways.end())
            ways.push_back(way);
    };
    if (sender.host == receiver.host && home_in(places[0]) == home_in(places[1]))
        add("");
    for (const auto& address : places[0])
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
    Json header{{"from", {{"drone", drone_of(sender.drone)}}}};
    if (!sender.port.empty())
        header["from"]["output"] = sender.port;
    if (!receiver.port.empty())
        header["input"] = receiver.port;
    ask(receiver.drone, PacketType::disconnect, header);
}

}  // namespace hive
