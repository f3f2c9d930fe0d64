// What no single drone shows: machines that are busy, and names that two machines use.
#pragma once

#include "look.hpp"

#include <hive/explain.hpp>

namespace hive::explaining {

/// Processors that are busy all the time, and memory that is short: what two looks at one run of a drone show of its
/// machine, and which drones use most. Clocks of two machines that differ by more than a second.
std::vector<Cause> machine_causes(const Look& first, const Look& second);
/// Drones of one name on several machines.
std::vector<Cause> same_names(const Look& look);

}  // namespace hive::explaining
