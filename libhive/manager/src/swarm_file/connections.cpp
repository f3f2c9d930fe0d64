// Reads the connections of a swarm file.
#include "../match_ports.hpp"
#include "reader.hpp"
#include "words.hpp"

#include <hive/connection_option.hpp>
#include <hive/name.hpp>

#include <algorithm>

namespace hive::swarm_file {
namespace {

constexpr std::size_t most_connections = 100'000;  // globs on both sides multiply

}  // namespace

std::span<const std::string_view> connection_keys()
{
    static const auto keys = [] {
        std::vector all{"from"sv, "to"sv, "share"sv};
        std::ranges::transform(connection_option_table(), std::back_inserter(all), &ConnectionOption::name);
        return all;
    }();
    return keys;
}

void Reader::read_connection(const Value& connection)
{
    Members members(mistakes_, connection, "a connection", connection_keys());
    const auto from = members.require("from"), to = members.require("to");
    const auto options = read_connection_options(members);
    const bool shared = members.flag("share");
    std::vector<Endpoint> senders;
    if (from)
        for (const auto& [text, value] : texts_of(mistakes_, *from))
            std::ranges::move(ends_of(text, value), std::back_inserter(senders));
    if (to)
        for (const auto& [text, value] : texts_of(mistakes_, *to))
            connect_all(senders, ends_of(text, value), options, shared, value);
}

void Reader::connect_all(const std::vector<Endpoint>& senders, const std::vector<Endpoint>& receivers,
                         const ConnectionOptions& options, bool shared, const Value& to)
{
    for (const auto& sender : senders)
        for (const auto& receiver : receivers) {
            SwarmConnection connection{sender, receiver, options};
            if (shared && options.group.empty())
                connection.options.group = sender.drone;
            if (!add_connection(std::move(connection), to))
                return;
        }
}

ConnectionOptions Reader::read_connection_options(Members& members)
{
    ConnectionOptions options;
    for (const auto& option : connection_option_table())
        if (const auto value = members.find(option.name); value && !option.set(options, *value->json))
            mistakes_.at_value(*value, in_quotes(option.name) + " must be " + std::string(option.must) + ", not "
                                           + shown(*value->json));
    check_clashes(members);
    return options;
}

void Reader::check_clashes(Members& members)
{
    const auto given = [&](std::string_view key) {
        const auto value = members.find(key);
        return value && *value->json != Json(false);
    };
    for (const auto& [one, other] : connection_clashes())
        if (given(one) && given(other))
            mistakes_.at_key(*members.find(other), in_quotes(other) + " conflicts with " + in_quotes(one));
    if (given("lease") && !given("share") && !given("group"))
        mistakes_.at_key(*members.find("lease"), in_quotes("lease") + std::string(for_shared_work),
                         "add \"share\": true, or a \"group\"");
}

std::vector<Endpoint> Reader::ends_of(const std::string& text, const Value& value)
{
    if (text.find_first_of("*?") != std::string::npos)
        return ends_like(text, value);
    if (places_.contains(text))
        return {{text, ""}};
    const auto end = parse_endpoint(text);
    if (!places_.contains(end.drone)) {
        no_drone(text, value);
        return {};
    }
    if (is_name(end.port))
        return {end};
    mistakes_.at_value(value, in_quotes(end.port) + " is not the name of a port", "write DRONE or DRONE.PORT");
    return {};
}

/// The part after the last dot may be a port or belong to the name; a match of a whole drone name wins.
std::vector<Endpoint> Reader::ends_like(const std::string& glob, const Value& value)
{
    const auto all_like = [&](std::string_view pattern, const std::string& port) {
        std::vector<Endpoint> found;
        for (const auto& drone : plan_.drones)
            if (matches_glob(pattern, drone.name))
                found.push_back({drone.name, port});
        return found;
    };
    auto found = all_like(glob, "");
    if (const auto end = parse_endpoint(glob); found.empty() && is_name(end.port))
        found = all_like(end.drone, end.port);
    if (found.empty() && !all_unclear_ && unclear_.empty())
        mistakes_.at_value(value, "no drone of this file fits " + in_quotes(glob));
    return found;
}

/// May it be a drone of an entry that could not be read?
bool Reader::is_unclear(const std::string& text) const
{
    return all_unclear_ || std::ranges::any_of(unclear_, [&](const std::string& name) {
               return text.starts_with(name)
                      && (text.size() == name.size() || text.find_first_of("-.", name.size()) == name.size());
           });
}

void Reader::no_drone(const std::string& text, const Value& value)
{
    if (is_unclear(text))
        return;
    if (counted_.contains(text))
        return mistakes_.at_value(value, text + " has a count, so no drone is called just " + text,
                                  "write \"" + text + "-*\" for all of them");
    mistakes_.at_value(value, misspelt("there is no drone " + in_quotes(text) + " in this file", text, plan_.drones,
                                       &SwarmDrone::name));
}

bool Reader::add_connection(SwarmConnection connection, const Value& to)
{
    const auto before = mistakes_.count();
    if (plan_.connections.size() == most_connections)
        mistakes_.at_value(to, "more than " + std::to_string(most_connections) + " connections");
    else if (connection.from.drone == connection.to.drone)
        mistakes_.at_value(to, connection.to.drone + " cannot be connected to itself");
    if (mistakes_.count() > before)
        return false;
    try {
        check_ports(connection);
    } catch (const Error& error) {
        mistakes_.at_value(to, error);
    }
    const auto from = to_text(connection.from), receiver = to_text(connection.to);
    if (!connected_.insert(from + " " + receiver).second)
        mistakes_.at_value(to, from + " is connected to " + receiver + " already");
    plan_.connections.push_back(std::move(connection));
    return mistakes_.count() == before;
}

/// Fills in the ports, as far as the interfaces of both are known. Throws as Application::connect.
void Reader::check_ports(SwarmConnection& connection)
{
    const auto interface_of_drone = [&](const std::string& drone) {
        return interface(plan_.drones[places_.at(drone)].kind);
    };
    const auto *from = interface_of_drone(connection.from.drone), *to = interface_of_drone(connection.to.drone);
    if (from && !connection.from.port.empty())
        port_named(from->outputs, connection.from.drone, "output", connection.from.port);
    if (to && !connection.to.port.empty())
        port_named(to->inputs, connection.to.drone, "input", connection.to.port);
    if (to && to->stateful && !connection.options.group.empty())
        throw sharing_refused(connection.to.drone);
    if (!from || !to)
        return;
    const auto [output, input] = match_ports(connection.from, *from, connection.to, *to);
    connection.from.port = output->name;
    connection.to.port = input->name;
    if (const auto& encoding = connection.options.encoding; !encoding.empty())
        require_encoding(*output, encoding, connection.to.drone, input->type);
}

}  // namespace hive::swarm_file
