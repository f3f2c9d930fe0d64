// Faults of the simulated network.
#pragma once

#include "world.hpp"

namespace hive::simulation {

/// Breaks one of the connections of a process with such peers, whose name is returned; empty: it has none.
std::string cut_one_connection(Process& process, const std::function<bool(const Process&)>& with);

/// Bytes sent by one end of such a connection arrive only after that time, and no other connection between the two
/// processes is opened before.
std::string silence_one_connection(Process& process, const std::function<bool(const Process&)>& with, Time until);

/// Bytes sent from one machine to the other arrive only after that time, and no connection between the two is opened
/// before.
void part_machines(int from, int to, Time until);

}  // namespace hive::simulation
