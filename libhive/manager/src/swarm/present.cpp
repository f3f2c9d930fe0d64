// Compares the statuses of drones with a plan.
#include "present.hpp"

#include "../directory.hpp"
#include "../inquiry.hpp"

#include <hive/event/clock.hpp>
#include <hive/event/home.hpp>
#include <hive/program.hpp>
#include <hive/transport/listen_address.hpp>

#include <algorithm>

namespace hive::swarm {
namespace {

/// Ports that are not named are inferred, and only one fits.
bool meets(const Endpoint& one, const Endpoint& other)
{
    return one.drone == other.drone && (one.port == other.port || one.port.empty() || other.port.empty());
}

std::string saved_swarm(const event::Home& home, const std::string& drone)
try {
    return home.read_state(drone).value_or(Json::object()).value("swarm", "");
} catch (const std::exception&) {
    return "";  // unreadable
}

}  // namespace

/// A drone has its name shortly before it is reachable.
Present::Present(Application& application, const std::vector<std::string>& drones)
{
    constexpr auto sockets_timeout = std::chrono::seconds(5);
    const auto end = event::Clock::now() + sockets_timeout;
    for (auto asked = drones; !asked.empty();) {
        std::vector<std::string> begun;
        for (auto& answer : application.status(asked))
            if (const auto* error = error_of(answer.status); !error)
                answers_.emplace(answer.drone, std::move(answer));
            else if (error->code() == Errc::unreachable && is_here(answer.place) && event::Clock::now() < end)
                begun.push_back(answer.drone);
            else if (error->code() == Errc::timeout && is_here(answer.place))
                silent_.emplace(answer.drone, saved_swarm(event::Home(application.home()), answer.drone));
            else if (error->code() != Errc::not_found && is_here(answer.place))
                throw *error;
        asked = std::move(begun);
        if (!asked.empty())
            Inquiry(application).wait(event::Clock::now() + std::chrono::milliseconds(5), {});
    }
}

const StatusAnswer* Present::find(const std::string& drone) const
{
    const auto found = answers_.find(drone);
    return found == answers_.end() ? nullptr : &found->second;
}

const InputStatus* Present::connection(const SwarmConnection& connection) const
{
    const auto* receiver = find(connection.to.drone);
    if (!receiver || !find(connection.from.drone))
        return nullptr;
    for (const auto& input : std::get<Status>(receiver->status).inputs)
        if (meets(connection.to, {connection.to.drone, input.input})
            && meets(connection.from, parse_endpoint(input.from)))
            return &input;
    return nullptr;
}

std::vector<SwarmConnection> Present::connections_of(const std::string& drone) const
{
    std::vector<SwarmConnection> found;
    for (const auto& [receiver, answer] : answers_)
        for (const auto& input : std::get<Status>(answer.status).inputs)
            if (const auto from = parse_endpoint(input.from); from.drone == drone || receiver == drone)
                found.push_back({from, {receiver, input.input}, input.options});
    return found;
}

bool same_ends(const SwarmConnection& one, const SwarmConnection& other)
{
    return meets(one.from, other.from) && meets(one.to, other.to);
}

std::string host_of(const SwarmPlan& plan, const SwarmDrone& drone)
{
    const auto engine = plan.engine_of(drone.host);
    if (engine.name != "ssh")
        return engine.name == "slurm" ? drone.host : Place::here;
    return machine_name(engine.settings.get<std::string>());
}

void require_same(const SwarmPlan& plan, const SwarmDrone& drone, const StatusAnswer& running)
{
    const std::string stop =
        (owns(plan, running) ? "" : "give yours another name, or ") + ("stop it: hivectl stop " + drone.name);
    if (!is_of_kind(std::get<Status>(running.status), drone.kind))
        throw Error(Errc::name_taken,
                    drone.name + " runs already and is a " + running_order(running, drone).kind + ", not a "
                        + drone.kind,
                    stop);
    if (const auto host = host_of(plan, drone); running.place.host != host)
        throw Error(Errc::name_taken, drone.name + " runs already on " + running.place.host + ", not on " + host, stop);
}

bool owns(const SwarmPlan& plan, const StatusAnswer& running)
{
    return std::get<Status>(running.status).swarm == plan.name;
}

std::string owner_text(const StatusAnswer& running)
{
    const auto& swarm = std::get<Status>(running.status).swarm;
    return "brought up by " + (swarm.empty() ? "no swarm" : "the swarm " + swarm);
}

DroneOrder running_order(const StatusAnswer& answer, const DroneOrder& otherwise)
{
    const auto& status = std::get<Status>(answer.status);
    auto order = status.order.value_or(otherwise);
    order.name = hive::drone_of(answer.drone);
    if (!status.order || order.kind.empty())
        order.kind = status.kind;
    order.host = answer.place.host;
    order.set = Json::object();
    for (const auto& field : order_fields())
        if (field.option.empty() && field.type != OrderField::Type::kind)  // for the engine: no drone has it
            field.copy(order, otherwise);
    order.on_exception = token(status.policy);
    order.halted = order.halted || status.state == State::halted;
    return order;
}

Json running_set(Application& application, const std::string& drone, const Json& asked)
{
    Json set = Json::object();
    for (const auto& parameter : application.describe(drone).parameters)
        if (const auto now = asked.find(parameter.name); now != asked.end() && *now != parameter.default_value)
            set[parameter.name] = *now;
    return set;
}

bool runs_as_wanted(const OrderField& field, const DroneOrder& wanted, const DroneOrder& running, const Place& place)
{
    if (field.change == OrderField::Change::never)
        return true;
    const auto value = field.value(wanted), value_now = field.value(running);
    if (field.type != OrderField::Type::address || value == value_now || value_now == "")
        return field.in_force(wanted) == field.in_force(running);
    const bool listens = field.name == "listen";
    const auto now = transport::listen_address(value_now.get<std::string>());
    if (value == "")
        return listens && !is_here(place) && now.host == "0.0.0.0";
    const auto meant = transport::listen_address(value.get<std::string>());
    const bool chosen = listens
                            ? !is_here(place)  // where its engine may choose any port
                                  || (now.port >= transport::first_drone_port && now.port <= transport::last_drone_port)
                            : now.port == transport::listen_address(running.listen).port;
    return meant.host == now.host && (meant.port == 0 ? chosen : meant.port == now.port);
}

}  // namespace hive::swarm
