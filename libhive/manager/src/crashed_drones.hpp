// Reads what drones have written of their crashes.
#pragma once

#include <hive/application.hpp>
#include <hive/event/home.hpp>

namespace hive {

/// Of those that do not run. Sorted.
std::vector<CrashedDrone> crashed_drones(const event::Home& home);

}  // namespace hive
