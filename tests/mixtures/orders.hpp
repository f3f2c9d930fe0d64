// What a ground asks of an application, the same way on real drones and in the simulated world.
#pragma once

#include "values.hpp"

#include <hive/application.hpp>

namespace hive::mixtures {

/// Sets work_ms and, if it is given, most_ms of all these drones together.
Told set(Application& asking, const Change& change);
/// Those of the workers among these drones that answer.
Settings settings_of(Application& asking, const std::vector<std::string>& drones);

}  // namespace hive::mixtures
