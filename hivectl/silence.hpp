// Why nothing comes from some outputs.
#pragma once

#include <hive/stall_search.hpp>

#include <string>
#include <vector>

namespace hivectl {

/// Asks the drones of the outputs, then those that they receive from, and so on up to the sources.
hive::Stall stall_behind(hive::Application& application, const std::vector<hive::Endpoint>& outputs);

/// The same, and where to look further: "axis: no camera: set url; see what is connected: hivectl connections".
std::string reason_for_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs);

/// Prints on stderr what is stalled, if anything is.
void report_stall(const std::string& verb, hive::Application& application, const std::vector<hive::Endpoint>& outputs);

}  // namespace hivectl
