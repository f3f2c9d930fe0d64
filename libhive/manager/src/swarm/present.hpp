// What runs of a plan.
#pragma once

#include <hive/swarm.hpp>

#include <map>
#include <string>
#include <vector>

namespace hive::swarm {

/// What some drones said of themselves at one time.
class Present {
public:
    /// Asks all at once. Throws what a drone of this machine answers that is there but tells nothing. Of one elsewhere
    /// that does not answer, only its place is known: it does not run until its engine says otherwise.
    Present(Application& application, const std::vector<std::string>& drones);

    /// Null: it does not run.
    [[nodiscard]] const StatusAnswer* find(const std::string& drone) const;
    /// The connection of an input from an output, if there is one; an empty port stands for any.
    [[nodiscard]] const InputStatus* connection(const SwarmConnection& connection) const;
    /// Those from or to this drone, as far as their receivers were asked.
    [[nodiscard]] std::vector<SwarmConnection> connections_of(const std::string& drone) const;

private:
    std::map<std::string, StatusAnswer> answers_;
};

/// Do both join the same output to the same input?
bool same_ends(const SwarmConnection& one, const SwarmConnection& other);

/// Where a drone of the plan is to run, as places call the machine.
std::string host_of(const SwarmPlan& plan, const SwarmDrone& drone);

/// Is this the drone of the plan, as far as it can be told? Throws Errc::name_taken when it is another one.
void require_same(const SwarmPlan& plan, const SwarmDrone& drone, const StatusAnswer& running);

/// Was it brought up by this swarm, and not by another one or by hand?
bool owns(const SwarmPlan& plan, const StatusAnswer& running);
/// "brought up by the swarm face"
std::string owner_text(const StatusAnswer& running);

/// What a drone runs with, but for its parameters.
/// @param otherwise  of a drone that does not tell, and what only its engine knows
DroneOrder running_order(const StatusAnswer& answer, const DroneOrder& otherwise);
/// Its parameters that do not have their defaults, as they were asked for.
Json running_set(Application& application, const std::string& drone, const Json& asked);

/// Does a drone that runs so have in this field what is wanted? An address without a port stands for any that the drone
/// chooses itself, and on another machine no address for all of that machine.
bool runs_as_wanted(const OrderField& field, const DroneOrder& wanted, const DroneOrder& running, const Place& place);

}  // namespace hive::swarm
