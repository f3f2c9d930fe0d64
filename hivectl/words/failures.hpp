// Many failures of a swarm in few lines.
#pragma once

#include <hive/swarm.hpp>

#include <string_view>
#include <vector>

namespace hivectl {

/// Failures whose first lines differ only in the drone's name and in numbers are alike. In the order of their first
/// ones.
std::vector<std::vector<hive::SwarmFailure>> alike(const std::vector<hive::SwarmFailure>& failures);

/// Prints the first 20 of those that are alike on stderr, and how many more there are; with --json all.
void complain_about(std::string_view verb, const std::vector<hive::SwarmFailure>& failures);

}  // namespace hivectl
