// What a swarm is made of: drones, the machines that they run on, and the connections between them.
#pragma once

#include <hive/connection_ends.hpp>

#include <string>
#include <vector>

namespace hive {

struct GraphDrone {
    std::string name;
    std::string host;   ///< as Place::host; empty: an application, or a drone that this home does not know
    std::string kind;   ///< empty: it does not answer
    std::string state;  ///< "idle", "halted"; "silent": it does not answer; empty: not known as a drone
};

struct SwarmGraph {
    std::vector<GraphDrone> drones;  ///< by host, then by name
    /// Without groups as a whole, and without those that only remember a receiver that is gone.
    std::vector<ConnectionEnds> connections;
};

/// Asks all drones.
SwarmGraph graph(Application& application);
SwarmGraph graph(const std::vector<StatusAnswer>& statuses);
/// In the language of Graphviz: machines are clusters.
std::string to_dot(const SwarmGraph& graph);
/// For people at a terminal: each drone, with what it sends, by machine.
std::string to_text(const SwarmGraph& graph);
/// {"drones": [{"name", "host", "kind", "state"}], "connections": [{"from", "to", "group", "connected"}]}
Json to_json(const SwarmGraph& graph);

}  // namespace hive
