// How what runs differs from a plan.
#pragma once

#include "present.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hive::swarm {

struct Differences {
    std::vector<SwarmStep> steps;         ///< in the order in which they are to be done
    SwarmPlan wanted;                     ///< the plan, with what drones that are to be restarted have beside it
    SwarmPlan ran;                        ///< those that are to be restarted, and their connections, as they run now
    std::vector<SwarmConnection> kept{};  ///< of those connections the ones that the restarted drones need again
};

/// @param before  the plan that was brought up last: what it had and this one has no more is ended, or returns to its
///                default; what was set or connected by hand beside both stays, and so does a drone that the swarm does
///                not own, unless the plan says `change_if_shared`
/// @param told    hears of each drone that is used as it was found
Differences differences(Application& application, const SwarmPlan& plan, const SwarmPlan& before,
                        const std::function<void(const std::string& text)>& told = {});

}  // namespace hive::swarm
