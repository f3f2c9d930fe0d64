// The drones of a simulated round, as the ticker and the sleeper on real ground.
#pragma once

#include <hive/drone.hpp>

#include <functional>

namespace hive::simulation {

/// An event of a source: when it was captured, its number since the last end, and since the start.
using OnCapture = std::function<void(std::int64_t captured_us, std::int64_t sequence, std::int64_t number)>;

/// Numbered events, live or on demand, up to `count`, which is the end if it `ends`.
void source(Drone& drone);
/// @param on_capture  called with each event before it is emitted
void source(Drone& drone, OnCapture on_capture);
/// Works on each event for a while, throws or refuses on request.
void worker(Drone& drone);

}  // namespace hive::simulation
