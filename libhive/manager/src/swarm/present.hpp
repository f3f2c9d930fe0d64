// The running drones of a plan.
#pragma once

#include <hive/swarm.hpp>

#include <map>
#include <string>
#include <vector>

namespace hive::swarm {

/// The statuses of some drones at one time.
class Present {
public:
    /// Queries all at once. Throws the error of a drone of this machine that answers with one. A drone elsewhere that
    /// does not answer has only its place: it counts as not running until its engine reports otherwise.
    Present(Application& application, const std::vector<std::string>& drones);

    /// Null: not running, or silent.
    [[nodiscard]] const StatusAnswer* find(const std::string& drone) const;
    /// The drones of this machine that run and do not answer, and the swarm of each, as far as that is saved.
    [[nodiscard]] const std::map<std::string, std::string>& silent() const noexcept { return silent_; }
    /// The connection of an input from an output, if there is one; an empty port stands for any.
    [[nodiscard]] const InputStatus* connection(const SwarmConnection& connection) const;
    /// Those from or to this drone, if their receivers were queried.
    [[nodiscard]] std::vector<SwarmConnection> connections_of(const std::string& drone) const;

private:
    std::map<std::string, StatusAnswer> answers_;
    std::map<std::string, std::string> silent_;
};

/// Do both connect the same output to the same input?
bool same_ends(const SwarmConnection& one, const SwarmConnection& other);

/// The host of a drone of the plan, as in Place::host.
std::string host_of(const SwarmPlan& plan, const SwarmDrone& drone);

/// Throws Errc::name_taken if this is not the drone of the plan, as far as that is known.
void require_same(const SwarmPlan& plan, const SwarmDrone& drone, const StatusAnswer& running);

/// Was it brought up by this swarm, and not by another one or by hand?
bool owns(const SwarmPlan& plan, const StatusAnswer& running);
/// "brought up by the swarm face"
std::string owner_text(const StatusAnswer& running);

/// The options of a running drone, without its parameters.
/// @param otherwise  for a drone that does not report them, and for what only its engine knows
DroneOrder running_order(const StatusAnswer& answer, const DroneOrder& otherwise);
/// Its parameters that differ from their defaults, as requested.
Json running_set(Application& application, const std::string& drone, const Json& asked);

/// Does a running drone have the wanted value in this field? An address without a port matches any port, and on another
/// machine no address matches all addresses of that machine.
bool runs_as_wanted(const OrderField& field, const DroneOrder& wanted, const DroneOrder& running, const Place& place);

}  // namespace hive::swarm
