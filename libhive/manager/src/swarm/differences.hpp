// Compares the running drones with a plan.
#pragma once

#include "present.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hive::swarm {

struct Differences {
    std::vector<SwarmStep> steps;         ///< in the order of execution
    SwarmPlan wanted;                     ///< the plan, plus what the drones to be restarted have in addition
    SwarmPlan ran;                        ///< the drones to be restarted and their connections, as they run now
    std::vector<SwarmConnection> kept{};  ///< those of these connections that the restarted drones need again
    std::vector<SwarmFailure> silent{};   ///< neither they nor their connections are changed
};

/// @param before  the plan that was brought up last: what only that plan has is stopped or returns to its default; what
///                was set or connected by hand stays, and so does a drone that the swarm does not own, unless the plan
///                has `change_if_shared`
/// @param told    notified of each drone that is used unchanged
Differences differences(Application& application, const SwarmPlan& plan, const SwarmPlan& before,
                        const std::function<void(const std::string& text)>& told = {});

}  // namespace hive::swarm
