// Finds the drones of a swarm that can stop now without loss.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <vector>

namespace hive::swarm {

/// Drones that receive from no other of these.
std::vector<std::string> sources(const std::vector<StatusAnswer>& drones);

/// Drones that receive from no other of these any more, have nothing in hand, and have no output events in flight.
/// Sources drain only after they were halted. A drone that does not answer is drained: no more events can come from it.
std::vector<std::string> drained(const std::vector<StatusAnswer>& drones);

}  // namespace hive::swarm
