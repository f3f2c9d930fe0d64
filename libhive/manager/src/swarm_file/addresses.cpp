// Reads the listening addresses and keys of the drones of a swarm file.
#include "reader.hpp"

#include <hive/transport/key.hpp>
#include <hive/transport/transport.hpp>

#include <algorithm>

namespace hive::swarm_file {
namespace {

/// Do two listeners at one port of a machine conflict?
bool overlap(const std::string& a, const std::string& b) { return a == b || a.empty() || b.empty(); }

/// The error in the key that a drone of this machine would use.
/// @param told  its file; empty: the default
std::optional<Error> problem_of_key(const std::string& told)
try {
    if (told.empty())
        require_key_to_listen(default_key_file(), "", "\"insecure\": true");
    else
        require_members(read_key_file(told), told);
    return std::nullopt;
} catch (const Error& error) {
    return error;
}

/// The error in the key that this machine needs for drones of others.
std::optional<Error> problem_of_own_key()
try {
    const auto file = default_key_file();
    if (file.empty())
        throw Error(Errc::not_permitted, "there is no swarm key", "make one: hivectl key new");
    require_members(read_key_file(file), file);
    return std::nullopt;
} catch (const Error& error) {
    return Error(error.code(), std::string("drones of other machines require the swarm's key, and ") + error.what(),
                 error.advice());
}

}  // namespace

void Reader::read_addresses(Members& members, Entry& entry)
{
    entry.listening = read_address(members, "listen", entry.drone.listen);
    const auto advertised = read_address(members, "advertise", entry.drone.advertise);
    if (advertised && advertised->is_everywhere())
        mistakes_.at_value(
            *members.find("advertise"), in_quotes(entry.drone.advertise) + ": cannot be dialed",
            "write tcp://HOST or tcp://HOST:PORT, with a host name or address that other machines can reach");
    const auto here = [](const std::string& host) { return host == Place::here; };
    if (advertised && !members.find("listen") && std::ranges::any_of(entry.hosts, here))
        mistakes_.at_key(*members.find("advertise"), "\"advertise\" needs a port to advertise",
                         "add \"listen\": \"tcp://0.0.0.0\"");
}

std::optional<transport::Address> Reader::read_address(Members& members, std::string_view key, std::string& text)
{
    const auto value = members.find(key);
    text = members.text(key).value_or("");
    if (text.empty())
        return std::nullopt;
    const std::string advice = "write tcp://HOST or tcp://HOST:PORT";
    try {
        const auto address = transport::listen_address(text);
        if (address.scheme == transport::Address::Scheme::tcp)
            return address;
        mistakes_.at_value(*value, in_quotes(text) + " is not a network address", advice);
    } catch (const Error& error) {
        mistakes_.at_value(*value, error.what(), advice);
    }
    return std::nullopt;
}

bool Reader::has_own_port(const SwarmDrone& drone, const Entry& entry)
{
    if (!entry.listening || entry.listening->port == 0)
        return true;
    auto& there = listening_[{drone.host, entry.listening->port}];
    const auto host = entry.listening->is_everywhere() ? "" : entry.listening->host;
    const auto found = std::ranges::find_if(there, [&](const auto& other) { return overlap(other.first, host); });
    if (found == there.end()) {
        there.emplace_back(host, drone.name);
        return true;
    }
    mistakes_.at_value(entry.value.member("listen", *entry.value.place->member("listen")),
                       drone.name + " and " + found->second + " both listen at port "
                           + std::to_string(entry.listening->port) + " of "
                           + (drone.host == Place::here ? "this machine" : drone.host),
                       "omit the port: each then takes a free one from 7700 up");
    return false;
}

void Reader::check_free_ports()
{
    constexpr int most = transport::last_drone_port - transport::first_drone_port + 1;
    struct Machine {
        bool listens;
        int drones = 0;
    };
    std::map<std::string, Machine> machines;
    const auto machine = [&](const std::string& host) -> Machine& {
        const auto [found, is_new] = machines.try_emplace(host);
        if (is_new) {
            const auto engine = plan_.engine_of(host).name;
            found->second.listens = engine != "local" && engine != "systemd";
        }
        return found->second;
    };
    for (const auto& entry : read_entries_)
        if (!entry.listening || entry.listening->port == 0)
            for (std::int64_t i = 0; i < entry.count.value_or(1); ++i) {
                const auto& host = entry.hosts[static_cast<std::size_t>(i) % entry.hosts.size()];
                auto& there = machine(host);
                if ((entry.listening || there.listens) && ++there.drones == most + 1)
                    mistakes_.at_key(entry.value,
                                     "more than " + std::to_string(most) + " drones of "
                                         + (host == Place::here ? "this machine" : host) + " need a free port",
                                     "name ports for some: \"listen\": \"tcp://0.0.0.0:PORT\"");
            }
}

void Reader::check_own_addresses()
{
    for (const auto& entry : read_entries_)
        if (entry.listening && starts_here(entry) && !transport::is_of_this_machine(*entry.listening))
            mistakes_.at_value(entry.value.member("listen", *entry.value.place->member("listen")),
                               in_quotes(entry.drone.listen) + ": this machine does not have this address",
                               "for all of its addresses: \"listen\": \"tcp://0.0.0.0\"");
}

void Reader::check_keys()
{
    std::map<std::string, std::optional<Error>> problems;
    for (const auto& entry : read_entries_) {
        const auto& told = entry.drone.key;
        const auto* place = entry.value.place->member(told.empty() ? "listen" : "key");
        if (entry.drone.insecure || !place || (told.empty() && !entry.listening) || !starts_here(entry))
            continue;
        if (!problems.contains(told))
            problems[told] = problem_of_key(told);
        if (const auto& problem = problems.at(told))
            mistakes_.at_value(entry.value.member(told.empty() ? "listen" : "key", *place), *problem);
    }
    const auto found = std::ranges::find_if(
        read_entries_, [&](const Entry& entry) { return !entry.drone.insecure && starts_elsewhere(entry); });
    if (const auto problem = found == read_entries_.end() ? std::nullopt : problem_of_own_key()) {
        const auto* on = found->value.place->member("on");
        on ? mistakes_.at_value(found->value.member("on", *on), *problem) : mistakes_.at_key(found->value, *problem);
    }
}

}  // namespace hive::swarm_file
