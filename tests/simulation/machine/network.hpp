// Faults of the simulated network.
#pragma once

#include "world.hpp"

namespace hive::simulation {

/// Breaks one of the connections of a process; false when it has none.
bool cut_one_connection(Process& process);

}  // namespace hive::simulation
