// Why nothing comes from some outputs.
#pragma once

#include <hive/stall_search.hpp>

#include <string>
#include <vector>

namespace hivectl {

using Standstill = hive::Stall;

/// Asks the drones of the outputs, then those that they receive from, and so on up to the sources.
Standstill standstill_behind(hive::Application& application, const std::vector<hive::Endpoint>& outputs);

/// The same, and where to look further: "axis: no camera: set url; see what is connected: hivectl edges".
std::string reason_for_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs);

/// Says on stderr what stands still, if anything does.
void tell_standstill(const std::string& verb, hive::Application& application,
                     const std::vector<hive::Endpoint>& outputs);

}  // namespace hivectl
