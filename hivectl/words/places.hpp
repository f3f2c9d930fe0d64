// Describes places of drones for people.
#pragma once

#include <hive/application.hpp>

#include <string>

namespace hivectl {

/// "cam1" of tcp://cam1:7700.
std::string host_of(const std::string& address);
/// On another machine?
bool is_elsewhere(const hive::Place& place);
/// "tcp://cam1:7700 (cam1)"
std::string place_text(const hive::Place& place);
/// The time of its last answer: "answered 3 min ago".
std::string answered_text(const hive::Place& place);

}  // namespace hivectl
