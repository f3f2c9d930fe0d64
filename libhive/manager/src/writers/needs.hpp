// Finds devices and folders that drones use, by the paths in their parameters.
#pragma once

#include <hive/swarm_plan.hpp>

#include <map>
#include <set>
#include <string>

namespace hive {

struct Needs {
    std::set<std::string> files;    ///< as the parameters name them, devices included: "/data/run.hive"
    std::set<std::string> devices;  ///< "/dev/video0"; without paths that have a ':', which no container takes
    std::set<std::string> folders;  ///< see folder_of()
};

/// By drone.
std::map<std::string, Needs> needs_of(const SwarmPlan& plan, const InterfaceOfKind& interface_of);

/// "/data" for "/data/run.hive". Empty for a folder of the system, over which a container must not mount anything, and
/// for a path that is relative or has a ".." or a ':'.
std::string folder_of(const std::string& path);

}  // namespace hive
