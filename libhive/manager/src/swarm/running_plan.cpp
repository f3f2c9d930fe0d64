// Asks every drone for its interface, its values and its connections.
#include "running_plan.hpp"

#include "../directory.hpp"
#include "record.hpp"

#include <algorithm>

namespace hive::swarm {
namespace {

constexpr std::string_view on_network = "tcp://";

/// What is not as it would be without being told.
Json told(const Interface& interface, const Json& values)
{
    Json set = Json::object();
    for (const auto& parameter : interface.parameters)
        if (const auto now = values.find(parameter.name); now != values.end() && *now != parameter.default_value)
            set[parameter.name] = *now;
    return set;
}

/// Where a drone of this machine listens besides the home.
std::string listens_at(const StatusAnswer& answer)
{
    for (const auto& place : answer.status.places)
        if (is_here(answer.place) && place.starts_with(on_network))
            return place;
    return {};
}

SwarmDrone planned(const StatusAnswer& answer)
{
    SwarmDrone drone{.name = hive::drone_of(answer.drone), .kind = answer.status.kind, .host = answer.place.host};
    drone.halted = answer.status.state == State::halted;
    drone.on_exception = answer.status.policy == ExceptionPolicy::halt ? "halt" : "";
    drone.listen = listens_at(answer);
    return drone;
}

/// What a drone does not tell of itself, its file does.
void add_remembered(SwarmDrone& drone, const SwarmPlan& remembered)
{
    const auto* before = remembered.drone(drone.name);
    if (!before || before->kind != drone.kind)
        return;
    drone.host = before->host;
    drone.restart = before->restart;
    drone.log_level = before->log_level;
    drone.key = before->key;
    drone.insecure = before->insecure;
    drone.remote_operator = before->remote_operator;
    drone.change_if_shared = before->change_if_shared;
    drone.advertise = before->advertise;
    if (!before->advertise.empty() || !before->listen.empty())
        drone.listen = before->listen;
}

void add_connections(SwarmPlan& plan, const StatusAnswer& answer)
{
    for (const auto& input : answer.status.inputs) {
        const auto dot = input.from.rfind('.');
        const Endpoint from{input.from.substr(0, dot), input.from.substr(dot + 1)};
        if (plan.drone(from.drone))
            plan.connections.push_back({from, {hive::drone_of(answer.drone), input.input}, input.options});
    }
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
        for (const auto* error : {&answers[i].error, &values[i].error})
            if (*error)
                throw **error;
        auto drone = planned(answers[i]);
        drone.set = told(application.describe(drones[i]), values[i].result);
        add_remembered(drone, remembered);
        if (!remembered.drone(drone.name))
            add_engine(plan, answers[i].place);
        plan.drones.push_back(std::move(drone));
    }
    for (const auto& answer : answers)
        add_connections(plan, answer);
    return plan;
}

}  // namespace hive::swarm
