// Inspects the connections and counters of each drone.
#include "draining.hpp"

#include <algorithm>
#include <set>

namespace hive::swarm {
namespace {

/// The drones that receive from another one of these, by name.
std::set<std::string> receivers_among(const std::vector<StatusAnswer>& drones)
{
    std::set<std::string> running, receivers;
    for (const auto& drone : drones)
        if (value_of(drone.status))
            running.insert(drone.drone);
    for (const auto& drone : drones)
        if (const auto* status = value_of(drone.status))
            for (const auto& input : status->inputs)
                if (const auto sender = parse_endpoint(input.from).drone;
                    sender != drone.drone && running.contains(sender))
                    receivers.insert(drone.drone);
    return receivers;
}

bool has_in_hand(const Status& status)
{
    return status.state == State::busy || std::ranges::any_of(status.inputs, [](const InputStatus& input) {
               return input.queued > 0 || input.in_hand > 0;
           });
}

bool has_on_its_way(const Status& status)
{
    return std::ranges::any_of(status.outputs, [](const OutputStatus& output) {
        return std::ranges::any_of(
            output.edges, [](const EdgeStatus& edge) { return edge.connected && edge.events.in_flight() > 0; });
    });
}

}  // namespace

std::vector<std::string> sources(const std::vector<StatusAnswer>& drones)
{
    const auto receivers = receivers_among(drones);
    std::vector<std::string> names;
    for (const auto& drone : drones)
        if (value_of(drone.status) && !receivers.contains(drone.drone))
            names.push_back(drone.drone);
    return names;
}

std::vector<std::string> drained(const std::vector<StatusAnswer>& drones)
{
    const auto receivers = receivers_among(drones);
    std::vector<std::string> names;
    for (const auto& drone : drones)
        if (const auto* status = value_of(drone.status);
            !status || (!receivers.contains(drone.drone) && !has_in_hand(*status) && !has_on_its_way(*status)))
            names.push_back(drone.drone);
    return names;
}

}  // namespace hive::swarm
