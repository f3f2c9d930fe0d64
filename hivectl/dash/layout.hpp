// The swarm as a text for Graphviz, with an id for each drone and each connection by which the page finds them.
#pragma once

#include <hive/graph.hpp>

#include <string>

namespace hivectl::dash {

/// "camera.image>face.image>GROUP": by this the page calls a connection.
std::string id_of(const hive::ConnectionEnds& ends);
/// The name of the drone at an end, or of the application.
std::string owner_of(const std::string& end, const hive::SwarmGraph& graph);
/// Machines are clusters. Drones that send and receive alike stand in several columns if there are many. What changes
/// from second to second is left to the page, so equal swarms have equal texts.
std::string dot_of(const hive::SwarmGraph& graph);

}  // namespace hivectl::dash
