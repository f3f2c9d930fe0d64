// Lookups in a plan.
#include <hive/name.hpp>
#include <hive/swarm_plan.hpp>

#include <algorithm>

namespace hive {

const SwarmDrone* SwarmPlan::drone(std::string_view drone_name) const
{
    const auto found = std::ranges::find(drones, drone_name, &SwarmDrone::name);
    return found == drones.end() ? nullptr : &*found;
}

SwarmEngine SwarmPlan::engine_of(const std::string& host) const
{
    for (const auto& [glob, engine] : engines)
        if (matches_glob(glob, host))
            return engine;
    if (host == Place::here)
        return {"local", Json::object()};
    return {"ssh", host};
}

}  // namespace hive
