// What drones tell of themselves, for people and for comparing.
#pragma once

#include "status_of.hpp"

namespace hive::mixtures {

std::string to_text(const EdgeStatus& edge);
std::string to_text(const InputStatus& input);
/// A line for each drone and each end of an edge, without what changes by itself: times and states.
std::string picture(const Statuses& statuses);
/// Differs when the picture does; for comparing alone.
std::string fingerprint(const Statuses& statuses);

}  // namespace hive::mixtures
