// Reads the crash reports of drones.
#pragma once

#include <hive/application.hpp>
#include <hive/event/home.hpp>

namespace hive {

/// Of drones that are not running. Sorted.
std::vector<CrashedDrone> crashed_drones(const event::Home& home);

}  // namespace hive
