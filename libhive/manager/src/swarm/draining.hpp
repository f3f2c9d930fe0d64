// Which drones of a swarm may end now without anything being lost.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <vector>

namespace hive::swarm {

/// Those that receive from no other of these.
std::vector<std::string> sources(const std::vector<StatusAnswer>& drones);

/// Those that receive from no other of these any more, have nothing in hand, and of whose outputs nothing is on its
/// way. Sources drain only after they were halted. What does not answer is drained: nothing more can come of it.
std::vector<std::string> drained(const std::vector<StatusAnswer>& drones);

}  // namespace hive::swarm
