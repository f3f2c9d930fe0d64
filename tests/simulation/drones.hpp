// The drones of a simulated round: what the ticker and the sleeper are on real ground.
#pragma once

#include <hive/drone.hpp>

namespace hive::simulation {

/// Numbered events, live or on demand, up to `count`.
void source(Drone& drone);
/// Takes its time over each event, throws or refuses when it is told to.
void worker(Drone& drone);

}  // namespace hive::simulation
