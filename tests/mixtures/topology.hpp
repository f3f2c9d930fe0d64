// Which drones a round has and how they are connected.
#pragma once

#include "plan.hpp"
#include "random.hpp"

namespace hive::mixtures {

/// From two drones to six.
Topology make_topology(Random& random);

}  // namespace hive::mixtures
