// Builds the graph of a swarm from the statuses of its drones. Graphviz draws it.
#include <hive/graph.hpp>
#include <hive/printable.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace hive {
namespace {

/// The drone of "camera.image" among those of the graph, or the whole text: an application.
std::string owner_of(const std::string& end, const std::set<std::string>& drones)
{
    auto name = parse_endpoint(end).drone;
    return drones.contains(name) ? name : end;
}

/// Events that were lost against a promise, as audit counts them.
std::int64_t lost(const Ledger& events)
{
    return events.lost() - events.of(Fate::lost_left) + events.of(Fate::dropped) + events.of(Fate::abandoned);
}

/// @param crashed  the names of drones that do not run
bool is_there(const ConnectionEnds& ends, const std::set<std::string>& crashed)
{
    if (ends.is_group() || ends.at_receiver)
        return !ends.is_group();
    const auto& edge = *ends.at_sender;
    const bool receiver_runs = !ends.to_host.empty();
    return edge.connected || edge.why == Reason::place_kept || crashed.contains(owner_of(ends.to, crashed))
           || (lost(edge.events) > 0 && !receiver_runs);
}

bool is_connected(const ConnectionEnds& ends)
{
    return (!ends.at_sender || ends.at_sender->connected) && (!ends.at_receiver || ends.at_receiver->connected);
}

std::string quoted(const std::string& text)
{
    std::string result = "\"";
    for (const char c : printable(text))
        result += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return result + "\"";
}

std::string port_of(const std::string& end, const std::string& drone)
{
    return end == drone ? "" : end.substr(drone.size() + 1);
}

std::string details_of(const GraphDrone& drone)
{
    return drone.kind.empty() ? drone.state.empty() ? "application" : drone.state : drone.kind + ", " + drone.state;
}

std::set<std::string> names_of(const SwarmGraph& graph)
{
    std::set<std::string> names;
    for (const auto& drone : graph.drones)
        names.insert(drone.name);
    return names;
}

std::string group_text(const ConnectionEnds& ends)
{
    return ends.options().group.empty() ? "" : " (group " + ends.options().group + ")";
}

/// Red: the drone has crashed, or does not answer. Yellow: halted or stopping.
std::string_view style_of(const GraphDrone& drone)
{
    return drone.host.empty()                                     ? "style=dashed"
           : drone.kind.empty()                                   ? "fillcolor=mistyrose"
           : drone.state == "halted" || drone.state == "stopping" ? "fillcolor=lightyellow"
                                                                  : "fillcolor=white";
}

/// "\\n" is a line end of Graphviz, so it is not quoted.
std::string node_text(const GraphDrone& drone)
{
    auto label = quoted(drone.name);
    label.insert(label.size() - 1, "\\n" + details_of(drone));
    return quoted(drone.name) + " [label=" + label + ", " + std::string(style_of(drone)) + "];\n";
}

}  // namespace

std::vector<GraphDrone> crashed(Application& application)
{
    std::map<std::string, GraphDrone> drones;
    const auto add = [&](const std::string& name, const std::string& state, const std::string& note) {
        drones[name] = {.name = name, .host = Place::here, .kind = {}, .state = state, .note = note};
    };
    for (const auto& name : application.remembered())
        add(name, "crashed", "");
    for (const auto& crash : application.crashed())
        add(crash.drone, "crashed", crash.signal + (crash.function.empty() ? "" : " in " + crash.function));
    for (const auto& failed : application.failed())
        add(failed.drone, "failed", failed.reason);
    std::vector<GraphDrone> all;
    for (auto& [name, drone] : drones)
        all.push_back(std::move(drone));
    return all;
}

SwarmGraph graph(Application& application)
{
    auto gone = crashed(application);  // first: a drone that is restarted meanwhile has a status
    return graph(application.status(application.drones()), std::move(gone));
}

SwarmGraph graph(const std::vector<StatusAnswer>& statuses, std::vector<GraphDrone> crashed)
{
    SwarmGraph graph;
    for (const auto& answer : statuses) {
        const auto* status = value_of(answer.status);
        graph.drones.push_back({.name = answer.drone,
                                .host = answer.place.host,
                                .kind = status ? status->kind : "",
                                .state = status ? std::string(token(status->state)) : "silent"});
    }
    auto names = names_of(graph);
    std::set<std::string> gone;
    for (auto& drone : crashed)
        if (names.insert(drone.name).second) {
            gone.insert(drone.name);
            graph.drones.push_back(std::move(drone));
        }
    for (auto& ends : connection_ends(statuses)) {
        if (!is_there(ends, gone))
            continue;
        for (const auto& end : {ends.from, ends.to}) {
            const auto owner = owner_of(end, names);
            if (names.insert(owner).second)
                graph.drones.push_back({.name = owner, .host = {}, .kind = {}, .state = "gone"});
            auto& drone = *std::ranges::find(graph.drones, owner, &GraphDrone::name);
            if (drone.state == "gone" && is_connected(ends))
                drone.state.clear();
        }
        graph.connections.push_back(std::move(ends));
    }
    std::ranges::sort(graph.drones, {}, [](const GraphDrone& drone) { return std::tie(drone.host, drone.name); });
    return graph;
}

std::string to_dot(const SwarmGraph& graph)
{
    const auto names = names_of(graph);
    std::map<std::string, std::string> machines;
    for (const auto& drone : graph.drones)
        machines[drone.host] += "    " + node_text(drone);
    std::string text =
        "digraph swarm {\n  rankdir=LR;\n  node [shape=box, style=\"rounded,filled\", fontname=\"sans-serif\"];\n  "
        "edge [fontname=\"sans-serif\", fontsize=10];\n  graph [fontname=\"sans-serif\", style=rounded, color=gray];\n";
    for (const auto& [host, nodes] : machines)
        text += host.empty() ? nodes
                             : "  subgraph " + quoted("cluster " + host) + " {\n    label=" + quoted(host) + ";\n"
                                   + nodes + "  }\n";
    for (const auto& ends : graph.connections) {
        const auto from = owner_of(ends.from, names), to = owner_of(ends.to, names);
        text += "  " + quoted(from) + " -> " + quoted(to)
                + " [label=" + quoted(port_of(ends.from, from) + group_text(ends))
                + (is_connected(ends) ? "" : ", style=dotted") + "];\n";
    }
    return text + "}\n";
}

std::string to_text(const SwarmGraph& graph)
{
    const auto names = names_of(graph);
    std::string text, host;
    for (const auto& drone : graph.drones) {
        if (drone.host.empty())
            continue;  // listed at its senders
        if (drone.host != host)
            text += (text.empty() ? "" : "\n") + (host = drone.host) + ":\n";
        text += "  " + drone.name + " (" + details_of(drone) + ")\n";
        for (const auto& ends : graph.connections)
            if (owner_of(ends.from, names) == drone.name)
                text += "    " + printable(port_of(ends.from, drone.name) + " -> " + ends.to + group_text(ends))
                        + (is_connected(ends) ? "" : ", not connected") + "\n";
    }
    return text;
}

Json to_json(const SwarmGraph& graph)
{
    Json drones = Json::array(), connections = Json::array();
    for (const auto& drone : graph.drones)
        drones.push_back({{"name", drone.name},
                          {"host", drone.host},
                          {"kind", drone.kind},
                          {"state", drone.state},
                          {"note", drone.note}});
    for (const auto& ends : graph.connections)
        connections.push_back(
            {{"from", ends.from}, {"to", ends.to}, {"group", ends.options().group}, {"connected", is_connected(ends)}});
    return {{"drones", drones}, {"connections", connections}};
}

}  // namespace hive
