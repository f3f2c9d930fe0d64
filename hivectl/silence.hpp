// Why nothing comes from some outputs.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <vector>

namespace hivectl {

/// What their drones say of themselves, and where to look further: "axis: no camera: set url; see what is connected:
/// hivectl edges".
std::string reason_for_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs);

}  // namespace hivectl
