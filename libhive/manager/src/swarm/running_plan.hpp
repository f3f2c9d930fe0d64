// Exports the running swarm as a plan.
#pragma once

#include <hive/swarm_plan.hpp>

#include <string>
#include <vector>

namespace hive::swarm {

SwarmPlan running_plan(Application& application, const std::string& name, const std::vector<std::string>& drones);

}  // namespace hive::swarm
