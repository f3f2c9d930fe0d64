// Completes commands that need more than statuses, such as a parameter or a receiver.
#pragma once

#include "look.hpp"

#include <hive/explain.hpp>

#include <optional>
#include <vector>

namespace hive::explaining {

/// Queries the drones of the first causes, and completes their commands.
void complete(Application& application, std::vector<Cause>& causes);

/// The cause if the two run and are not connected: at all, the wrong way round, or because their types do not fit.
std::optional<Cause> unconnected_pair(Application& application, const Endpoint& sender, const Endpoint& receiver);

}  // namespace hive::explaining
