// Writes the hivectl commands that start and connect drones of a plan.
#pragma once

#include <hive/swarm_plan.hpp>

#include <string>

namespace hive {

/// "hivectl start face --as face-1 scale=1.1". Throws Errc::invalid_argument for a drone that Slurm starts.
std::string start_line(const SwarmPlan& plan, const SwarmDrone& drone);
/// "hivectl connect camera.image face-1.image --window 2"
std::string connect_line(const SwarmConnection& connection);

}  // namespace hive
