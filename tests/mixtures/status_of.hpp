// The status of drones as values.
#pragma once

#include <hive/application.hpp>
#include <hive/status.hpp>

#include <map>

namespace hive::mixtures {

using Statuses = std::map<std::string, Status>;

/// Those that answer.
Statuses statuses_of(Application& application, const std::vector<std::string>& drones);

}  // namespace hive::mixtures
