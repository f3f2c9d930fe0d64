// Finds devices and folders that a drone uses, by the paths in its parameters.
#pragma once

#include <hive/swarm_plan.hpp>

#include <set>
#include <string>

namespace hive {

/// "/dev/video0". Without paths that have a ':', which no container takes.
std::set<std::string> devices_of(const SwarmDrone& drone);

/// "/data" for "/data/run.hive". Without folders of the system, over which a container must not mount anything.
std::set<std::string> folders_of(const SwarmDrone& drone);

/// Empty for a folder of the system, and for a path that is relative or has a ".." or a ':'.
std::string folder_of(const std::string& path);

}  // namespace hive
