// What slows down all drones of a machine.
#pragma once

#include "look.hpp"

#include <hive/explain.hpp>

namespace hive::explaining {

/// Processors that are busy all the time, and memory that is short: what two looks at one run of a drone show of its
/// machine, and which drones use most. Clocks of two machines that differ by more than a second.
std::vector<Cause> machine_causes(const Look& first, const Look& second);

}  // namespace hive::explaining
