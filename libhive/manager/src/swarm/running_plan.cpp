// Queries every drone's interface, values and connections.
#include "running_plan.hpp"

#include "../directory.hpp"
#include "present.hpp"
#include "record.hpp"

#include <hive/program.hpp>

#include <algorithm>

namespace hive::swarm {
namespace {

/// Keeps the file's own text where it matches the running drone, and what only the file has.
void add_remembered(SwarmDrone& drone, const SwarmDrone& before, const Place& place)
{
    drone.host = before.host;
    for (const auto& field : order_fields())
        if (runs_as_wanted(field, before, drone, place))
            field.copy(drone, before);
}

SwarmDrone planned(Application& application, const StatusAnswer& answer, const Json& asked, const SwarmDrone* before)
{
    if (before && !is_of_kind(std::get<Status>(answer.status), before->kind))
        before = nullptr;
    auto drone = running_order(answer, before ? *before : SwarmDrone{});
    drone.set = running_set(application, answer.drone, asked);
    if (before)
        drone.kind = before->kind;
    add_remembered(drone, before ? *before : SwarmDrone{.host = drone.host}, answer.place);
    return drone;
}

void add_connections(SwarmPlan& plan, const StatusAnswer& answer)
{
    for (const auto& input : std::get<Status>(answer.status).inputs)
        if (const auto from = parse_endpoint(input.from); plan.drone(from.drone))
            plan.connections.push_back({from, {hive::drone_of(answer.drone), input.input}, input.options});
}

void add_engine(SwarmPlan& plan, const Place& place)
{
    if (!place.ssh.empty() && place.ssh != place.host
        && std::ranges::none_of(plan.engines, [&](const auto& engine) { return engine.first == place.host; }))
        plan.engines.emplace_back(place.host, SwarmEngine{"ssh", place.ssh});
}

}  // namespace

SwarmPlan running_plan(Application& application, const std::string& name, const std::vector<std::string>& drones)
{
    const auto remembered = Record(application.home(), name).read();
    SwarmPlan plan{.name = name, .drones = {}, .connections = {}, .engines = remembered.engines};
    const auto answers = application.status(drones);
    const auto values = application.asked(drones);
    for (std::size_t i = 0; i < answers.size(); ++i) {
        value_or_throw(answers[i].status);
        auto drone = planned(application, answers[i], value_or_throw(values[i].result),
                             remembered.drone(hive::drone_of(answers[i].drone)));
        if (!remembered.drone(drone.name))
            add_engine(plan, answers[i].place);
        plan.drones.push_back(std::move(drone));
    }
    for (const auto& answer : answers)
        add_connections(plan, answer);
    return plan;
}

}  // namespace hive::swarm
