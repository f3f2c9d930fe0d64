// Starting one drone, here or on a machine that ssh reaches.
#pragma once

#include <hive/swarm_plan.hpp>

#include <chrono>
#include <functional>
#include <string>

namespace hive {

struct StartOptions {
    SwarmDrone drone{};                       ///< an empty name: the usual one of its kind; `host` is not used
    std::string ssh{};                        ///< the machine as ssh knows it; empty: this one
    bool if_missing = false;                  ///< one of this name and kind that runs already counts as started
    std::chrono::milliseconds limit{10'000};  ///< for the drone to be ready
    std::function<bool()> cancelled{};        ///< asked while it waits; true: Errc::stopped
};

/// Starts a drone in the background and returns its place when it is ready. The drone keeps running when the caller
/// exits; whatever goes wrong, it is stopped again. On another machine, a drone of this name and kind that runs there
/// already, and that this home does not know, is left as it is and counts as started.
///
/// Throws Errc::name_taken when a drone has the name, Errc::not_found when there is no such program, Errc::failed with
/// the last lines of its log when it exits instead, Errc::timeout, and for other machines what Remote throws.
Place start(Application& application, StartOptions options);

}  // namespace hive
