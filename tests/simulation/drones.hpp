// The drones of a simulated round, as the ticker and the sleeper on real ground.
#pragma once

#include <hive/drone.hpp>

#include <functional>
#include <optional>
#include <string>

namespace hive::simulation {

/// An event of a source: when it was captured, its number since the last end, and since the start.
using OnCapture = std::function<void(std::int64_t captured_us, std::int64_t sequence, std::int64_t number)>;

/// Numbered events, live or on demand, up to `count`, which is the end if it `ends`.
void source(Drone& drone);
/// @param on_capture  called with each event before it is emitted
/// @param sizes       of the bodies, which can be encoded then; empty: all are small
void source(Drone& drone, OnCapture on_capture, std::function<std::size_t()> sizes = {});
/// Works on each event for a while, throws or refuses on request.
void worker(Drone& drone);
/// @param on_work  called with each event after that time; it may throw
void watched_worker(Drone& drone, std::function<void(const Event&)> on_work);
/// Gives each event on at two outputs.
void fork(Drone& drone);
/// Joins the events of two inputs.
void pair(Drone& drone);
/// Says what is wrong with a body of that source, or of a worker, which passes it on.
std::optional<std::string> wrong_body(const Event& event);

}  // namespace hive::simulation
