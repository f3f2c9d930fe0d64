// Chooses ports, and assembles arguments.
#include "command_lines.hpp"

#include "../directory.hpp"
#include "../engines/engine.hpp"

#include <hive/printable.hpp>
#include <hive/program.hpp>
#include <hive/protocol/connect_text.hpp>
#include <hive/remote.hpp>
#include <hive/transport/listen_address.hpp>

#include <algorithm>

namespace hive {
namespace {

/// As bash reads it, in $'…'.
std::string with_escapes(const std::string& word)
{
    std::string text;
    for (const char c : word)
        text += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return "$'"
           + escaped(text,
                     [](std::int32_t, std::string_view bytes) {
                         std::string result;
                         for (const char byte : bytes)
                             result += hex_escape(byte);
                         return result;
                     })
           + "'";
}

}  // namespace

std::string shell_word(const std::string& word)
{
    if (printable(word) != word)
        return with_escapes(word);
    constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%:=,./+-";
    return !word.empty() && word.find_first_not_of(plain) == std::string::npos ? word : quoted_for_shell(word);
}

std::string label_of(const std::string& name)
{
    std::string label;
    for (const char c : name)
        label += c == '_' || c == '.' ? '-' : (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
    while (label.ends_with('-'))
        label.pop_back();
    return label;
}

CommandLines::CommandLines(const SwarmPlan& plan, Machines machines, std::map<std::string, std::string> hosts)
    : machines_(machines), plan_(plan), hosts_(std::move(hosts))
{
    for (const auto& drone : plan.drones)
        drones_[drone.name] = &drone;
    for (const auto& connection : plan.connections)
        received_[connection.to.drone].push_back(&connection);
    choose_ports(plan);
}

std::string CommandLines::machine(const SwarmDrone& drone) const
{
    return machines_ == Machines::one_each ? drone.name : drone.host;
}

/// Ports of the plan are kept; other drones get the next free port of their machine, since their receivers must know
/// it.
void CommandLines::choose_ports(const SwarmPlan& plan)
{
    std::map<std::string, std::set<std::uint16_t>> taken;
    std::set<std::string> on_network;
    for (const auto& connection : plan.connections)
        if (machine(*drones_.at(connection.from.drone)) != machine(*drones_.at(connection.to.drone)))
            on_network.insert(connection.from.drone);
    for (const auto& drone : plan.drones)
        if (machines_ == Machines::one_each)
            ports_[drone.name] = only_port;
        else if (const auto port = drone.listen.empty() ? 0 : transport::listen_address(drone.listen).port; port != 0)
            taken[drone.host].insert(ports_[drone.name] = static_cast<std::uint16_t>(port));
        else if (!drone.listen.empty() || drone.host != Place::here)
            on_network.insert(drone.name);
    std::map<std::string, int> next;
    for (const auto& drone : plan.drones) {
        if (!on_network.contains(drone.name) || ports_.contains(drone.name))
            continue;
        auto& port = next.try_emplace(drone.host, transport::first_drone_port).first->second;
        while (taken[drone.host].contains(static_cast<std::uint16_t>(port)))
            ++port;
        if (port > transport::last_drone_port)
            throw Error(Errc::invalid_argument,
                        "there are more drones on " + drone.host + " than ports from 7700 to 9699",
                        "name ports for some: \"listen\": \"tcp://0.0.0.0:PORT\"");
        ports_[drone.name] = static_cast<std::uint16_t>(port++);
    }
}

std::string CommandLines::listening(const SwarmDrone& drone) const
{
    const auto port = ports_.find(drone.name);
    if (port == ports_.end())
        return {};
    const bool told = machines_ == Machines::as_planned && !drone.listen.empty();
    const auto host = told ? transport::listen_address(drone.listen).host : "0.0.0.0";
    return to_text(transport::Address{transport::Address::Scheme::tcp, host, port->second});
}

std::string CommandLines::advertised(const SwarmDrone& drone) const
{
    if (machines_ == Machines::one_each) {
        const auto host = hosts_.find(drone.name);
        return "tcp://" + (host == hosts_.end() ? drone.name : host->second) + ":" + std::to_string(only_port);
    }
    if (drone.advertise.empty())
        return {};
    auto address = transport::listen_address(drone.advertise);
    if (const auto port = ports_.find(drone.name); address.port == 0 && port != ports_.end())
        address.port = port->second;
    return to_text(address);
}

std::string CommandLines::address(const SwarmDrone& drone) const
{
    if (auto text = advertised(drone); !text.empty())
        return text;
    auto listen = transport::parse_address(listening(drone));
    if (listen.is_everywhere() && drone.host == Place::here)
        throw Error(Errc::invalid_argument, "other machines need the address of " + drone.name,
                    "set it in the file: \"advertise\": \"tcp://HOST\"");
    if (listen.is_everywhere())
        listen.host = machine_name(drone.host);
    return to_text(listen);
}

std::string CommandLines::connection(const SwarmConnection& connection, const SwarmDrone& receiver) const
{
    const auto& sender = *drones_.at(connection.from.drone);
    if (connection.from.port.empty())
        throw Error(Errc::invalid_argument,
                    "which output of " + sender.name + " " + receiver.name + " receives from is not known here",
                    "name it in the file: \"from\": \"" + sender.name + ".OUTPUT\"");
    const auto place = machine(sender) == machine(receiver) ? "" : address(sender);
    return protocol::to_text({sender.name, connection.from.port, place, connection.to.port, connection.options});
}

bool CommandLines::with_key() const { return !std::ranges::all_of(plan_.drones, &SwarmDrone::insecure); }

std::vector<std::string> CommandLines::metrics() const
{
    if (drones_.contains(metrics_name))
        throw Error(Errc::invalid_argument,
                    std::string("a drone is called ") + metrics_name + ", as the container of the metrics",
                    "give it another name");
    // Scrapers of containers have no token; the network is private to the containers.
    std::vector<std::string> words{"hivectl", "metrics", "--http", "0.0.0.0:" + std::to_string(metrics_port),
                                   "--insecure"};
    for (const auto& drone : plan_.drones)
        words.insert(words.end(), {"--place", drone.name + "=" + address(drone)});
    return words;
}

std::vector<std::string> CommandLines::of(const SwarmDrone& drone) const
{
    auto told = as_started(plan_, drone);
    told.listen = listening(drone);
    told.advertise = advertised(drone);
    if (machines_ == Machines::one_each)
        told.key.clear();  // that file is on another machine
    std::vector<std::string> words{"hive-" + drone.kind};
    if (is_python_file(drone.kind))
        words = {"python3", "-u", drone.kind};
    std::ranges::move(arguments_of(told), std::back_inserter(words));
    if (const auto found = received_.find(drone.name); found != received_.end())
        for (const auto* one : found->second)
            words.insert(words.end(), {"--connect", connection(*one, drone)});
    return words;
}

}  // namespace hive
