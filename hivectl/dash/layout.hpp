// Writes the swarm for Graphviz, with ids of drones and connections for the page.
#pragma once

#include <hive/graph.hpp>

#include <string>

namespace hivectl::dash {

/// "camera.image>face.image>GROUP": the page's id of a connection.
std::string id_of(const hive::ConnectionEnds& ends);
/// The name of the drone or application at an end.
std::string owner_of(const std::string& end, const hive::SwarmGraph& graph);
/// Machines are clusters. Many drones with the same connections are laid out in several columns. Up to 128 connections
/// have room for their rate and age; with more, labels would make the graph too wide to read. The page adds values that
/// change every second, so equal swarms have equal texts.
std::string dot_of(const hive::SwarmGraph& graph);

}  // namespace hivectl::dash
