#include "layout.hpp"

#include <hive/printable.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace hivectl::dash {
namespace {

std::string quoted(const std::string& text)
{
    std::string result = "\"";
    for (const char c : hive::printable(text))
        result += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return result + "\"";
}

/// The position of a drone among its twins: drones with the same senders and receivers.
struct Place {
    int column = 0, columns = 1;
    std::string left{};  ///< of twins without connections, the one in the column before
};

using Ends = std::set<std::pair<bool, std::string>>;  ///< sends to, or receives from

/// The number of columns that makes the graph about as wide as a screen.
int columns_of(std::size_t twins)
{
    constexpr std::size_t few = 8;
    constexpr double screen = 0.45;  // height of a drone / width of a column * 16 / 9
    return twins <= few ? 1 : static_cast<int>(std::ceil(std::sqrt(static_cast<double>(twins) * screen)));
}

std::map<std::string, Place> places_of(const hive::SwarmGraph& graph)
{
    std::map<std::string, Ends> ends;
    for (const auto& drone : graph.drones)
        ends[drone.name];
    for (const auto& connection : graph.connections) {
        const auto from = owner_of(connection.from, graph), to = owner_of(connection.to, graph);
        ends[from].emplace(true, to);
        ends[to].emplace(false, from);
    }
    std::map<std::pair<Ends, std::string>, std::vector<std::string>> twins;
    for (const auto& drone : graph.drones)
        twins[{ends[drone.name], drone.host}].push_back(drone.name);
    std::map<std::string, Place> places;
    for (const auto& [key, names] : twins)
        for (std::size_t i = 0; i < names.size(); ++i) {
            const auto columns = static_cast<std::size_t>(columns_of(names.size()));
            const auto column = i % columns;
            places[names[i]] = {static_cast<int>(column), static_cast<int>(columns),
                                key.first.empty() && column > 0 ? names[i - 1] : ""};
        }
    return places;
}

std::string node_text(const hive::GraphDrone& drone)
{
    auto label = quoted(drone.name);
    label.insert(label.size() - 1, "\\n" + (drone.kind.empty() ? "application" : drone.kind) + ", starting 00.0/s");
    return quoted(drone.name) + " [id=" + quoted("drone:" + drone.name) + ", class=\"drone\", label=" + label + "];\n";
}

}  // namespace

std::string id_of(const hive::ConnectionEnds& ends) { return ends.from + ">" + ends.to + ">" + ends.options().group; }

std::string owner_of(const std::string& end, const hive::SwarmGraph& graph)
{
    const auto name = hive::parse_endpoint(end).drone;
    return std::ranges::find(graph.drones, name, &hive::GraphDrone::name) == graph.drones.end() ? end : name;
}

std::string dot_of(const hive::SwarmGraph& graph)
{
    constexpr std::size_t many = 24, max_labelled = 128;
    const std::string between = graph.drones.size() > many ? "0.06" : "0.2";
    const auto places = places_of(graph);
    std::map<std::string, std::string> machines;
    for (const auto& drone : graph.drones)
        machines[drone.host] += "    " + node_text(drone);
    std::string text =
        "digraph swarm {\n  rankdir=LR; bgcolor=transparent; ranksep=0.4; nodesep=" + between
        + ";\n"
          "  node [shape=box, style=rounded, fontname=\"sans-serif\", fontsize=13, margin=\"0.14,0.08\"];\n"
          "  edge [fontname=\"sans-serif\", fontsize=11, arrowsize=0.7];\n"
          "  graph [fontname=\"sans-serif\", fontsize=13, style=rounded];\n";
    for (const auto& [host, nodes] : machines)
        text += host.empty() ? nodes
                             : "  subgraph " + quoted("cluster " + host)
                                   + " {\n    class=\"machine\"; label=" + quoted(host) + ";\n" + nodes + "  }\n";
    for (const auto& ends : graph.connections) {
        const auto from = owner_of(ends.from, graph), to = owner_of(ends.to, graph);
        const auto& group = ends.options().group;
        auto label = quoted(" 000.0/s " + (group.empty() ? "" : group + " "));
        label.insert(label.size() - 1, "\\n 00.0 ms ");
        const auto &first = places.at(from), &second = places.at(to);
        text += "  " + quoted(from) + " -> " + quoted(to) + " [id=" + quoted("edge:" + id_of(ends)) + ", class=\"edge\""
                + (graph.connections.size() > max_labelled ? "" : ", label=" + label)
                + ", minlen=" + std::to_string(first.columns - first.column + second.column) + "];\n";
    }
    for (const auto& [name, place] : places)
        if (!place.left.empty())
            text += "  " + quoted(place.left) + " -> " + quoted(name) + " [style=invis];\n";
    return text + "}\n";
}

}  // namespace hivectl::dash
