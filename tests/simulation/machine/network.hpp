// Faults of the simulated network.
#pragma once

#include "world.hpp"

namespace hive::simulation {

/// Breaks one of the connections of a process with such peers, whose name is returned; empty: it has none.
std::string cut_one_connection(Process& process, const std::function<bool(const Process&)>& with);

/// What one end of such a connection sends arrives only after that time, and no other connection between the two
/// processes is made before.
std::string silence_one_connection(Process& process, const std::function<bool(const Process&)>& with, Time until);

}  // namespace hive::simulation
