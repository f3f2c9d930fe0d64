// The graph of a swarm: drones, their machines, and their connections.
#pragma once

#include <hive/connection_ends.hpp>

#include <string>
#include <vector>

namespace hive {

struct GraphDrone {
    std::string name;
    std::string host;  ///< as Place::host; empty: an application, or a drone unknown to this home
    std::string kind;  ///< empty: no answer, or it does not run
    /// "idle", "halted"; "silent": no answer; "crashed", "failed": as crashed() returns it; "gone": no drone knows
    /// it as connected, but a sender awaits it, or counts losses for it; empty: an application
    std::string state;
    std::string note{};  ///< of a drone that crashed or failed: why
};

struct SwarmGraph {
    std::vector<GraphDrone> drones;  ///< by host, then by name
    /// Without the rows of groups as a whole. Those whose receiver is gone are included if it crashed, or if its sender
    /// awaits it or has lost events for it.
    std::vector<ConnectionEnds> connections;
};

/// Queries all drones.
SwarmGraph graph(Application& application);
/// @param crashed  of these drones, those that have no status are added
SwarmGraph graph(const std::vector<StatusAnswer>& statuses, std::vector<GraphDrone> crashed = {});
/// The drones of this home that crashed and do not run; "failed": their swarm restarted them repeatedly.
std::vector<GraphDrone> crashed(Application& application);
/// In the DOT language of Graphviz: machines are clusters.
std::string to_dot(const SwarmGraph& graph);
/// For terminals: each drone with its connections, by machine.
std::string to_text(const SwarmGraph& graph);
/// {"drones": [{"name", "host", "kind", "state"}], "connections": [{"from", "to", "group", "connected"}]}
Json to_json(const SwarmGraph& graph);

}  // namespace hive
