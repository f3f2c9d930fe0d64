// The graph of a swarm: drones, their machines, and their connections.
#pragma once

#include <hive/connection_ends.hpp>

#include <string>
#include <vector>

namespace hive {

struct GraphDrone {
    std::string name;
    std::string host;   ///< as Place::host; empty: an application, or a drone unknown to this home
    std::string kind;   ///< empty: no answer
    std::string state;  ///< "idle", "halted"; "silent": no answer; empty: not a known drone
};

struct SwarmGraph {
    std::vector<GraphDrone> drones;  ///< by host, then by name
    /// Without the rows of groups as a whole, and without connections whose receiver is gone.
    std::vector<ConnectionEnds> connections;
};

/// Queries all drones.
SwarmGraph graph(Application& application);
SwarmGraph graph(const std::vector<StatusAnswer>& statuses);
/// In the DOT language of Graphviz: machines are clusters.
std::string to_dot(const SwarmGraph& graph);
/// For terminals: each drone with its connections, by machine.
std::string to_text(const SwarmGraph& graph);
/// {"drones": [{"name", "host", "kind", "state"}], "connections": [{"from", "to", "group", "connected"}]}
Json to_json(const SwarmGraph& graph);

}  // namespace hive
