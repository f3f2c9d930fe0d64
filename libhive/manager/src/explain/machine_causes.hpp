// Finds causes that no single drone shows: overloaded machines, and names used on two machines.
#pragma once

#include "look.hpp"

#include <hive/explain.hpp>

namespace hive::explaining {

/// Machines whose processors are always busy or whose memory is low, from two queries of one run of a drone, and the
/// drones that use most. Clocks of two machines that differ by more than a second.
std::vector<Cause> machine_causes(const Look& first, const Look& second);
/// Drones of one name on several machines.
std::vector<Cause> same_names(const Look& look);

}  // namespace hive::explaining
