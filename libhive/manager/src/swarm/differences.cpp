// Compares drone by drone and connection by connection.
#include "differences.hpp"

#include "../directory.hpp"

#include <hive/event/clock.hpp>
#include <hive/name.hpp>
#include <hive/program.hpp>
#include <hive/transport/listen_address.hpp>

#include <algorithm>
#include <iterator>
#include <thread>

namespace hive::swarm {
namespace {

bool fits(const Endpoint& end, const std::string& drone, const std::string& port)
{
    return end.drone == drone && (end.port.empty() || end.port == port);
}

/// Ports that are not named are inferred, and only one fits.
bool meets(const Endpoint& one, const Endpoint& other)
{
    return one.drone == other.drone && (one.port == other.port || one.port.empty() || other.port.empty());
}

bool says(const DroneOrder& order, const OrderField& field) { return field.value(order) != field.value({}); }

bool may_change(const SwarmPlan& plan, const SwarmDrone& drone, const StatusAnswer& running)
{
    return drone.change_if_shared || owns(plan, running);
}

/// Compares the drones that run with what they are to run with.
class RunningDrones {
public:
    RunningDrones(Application& application, const SwarmPlan& plan, const SwarmPlan& before, const Present& present)
        : application_(application), plan_(plan), before_(before), present_(present)
    {
    }

    /// @return  the changes that are not made, since they are of drones of another swarm
    std::vector<SwarmStep> add_to(Differences& all);

private:
    struct Running {
        const SwarmDrone* planned;
        const SwarmDrone* before;  ///< null: it was not brought up, or by another swarm
        const StatusAnswer* answer;
        DroneOrder now{}, wanted{};
        bool shared = false, restart = false, other_kind = false;
    };

    [[nodiscard]] Running compared(const SwarmDrone& planned, const StatusAnswer& answer);
    [[nodiscard]] SwarmStep fields_of(Running& drone) const;
    [[nodiscard]] SwarmStep parameters_of(const Running& drone, const Json& present);
    void add_restart(Running& drone, const Json& present, Differences& all);
    const ParameterInfo* parameter(const std::string& drone, const std::string& name);

    Application& application_;
    const SwarmPlan& plan_;
    const SwarmPlan& before_;
    const Present& present_;
    std::string described_;
    Interface interface_;
};

/// A drone that the plan before had otherwise is changed; any other is somebody else's.
RunningDrones::Running RunningDrones::compared(const SwarmDrone& planned, const StatusAnswer& answer)
{
    const bool shared = !may_change(plan_, planned, answer);
    Running drone{.planned = &planned,
                  .before = shared ? nullptr : before_.drone(planned.name),
                  .answer = &answer,
                  .shared = shared};
    const bool known = drone.before && is_of_kind(answer.status, drone.before->kind)
                       && answer.place.host == host_of(before_, *drone.before);
    if (!known)
        require_same(plan_, planned, answer);
    auto otherwise = planned;
    if (drone.before && plan_.engine_of(planned.host).name == "systemd")
        otherwise.restart = drone.before->restart;
    drone.now = running_order(answer, otherwise);
    if (is_of_kind(answer.status, planned.kind))
        drone.now.kind = planned.kind;
    drone.wanted = drone.now;
    drone.wanted.name = planned.name;
    drone.wanted.host = planned.host;
    drone.wanted.restart = planned.restart;
    drone.wanted.swarm = drone.now.swarm = answer.status.swarm;
    for (const auto& field : order_fields())
        if (says(planned, field) || (drone.before && says(*drone.before, field))
            || runs_as_wanted(field, planned, drone.now,
                              answer.place))  // a port that it chose is not for another machine
            field.copy(drone.wanted, planned);
    return drone;
}

/// One step for all fields: a new process has them, or requests change them.
SwarmStep RunningDrones::fields_of(Running& drone) const
{
    SwarmStep step{.what = SwarmStep::What::change, .drone = drone.planned->name};
    for (const auto& field : order_fields()) {
        if (runs_as_wanted(field, drone.wanted, drone.now, drone.answer->place))
            continue;
        step.values[field.name] = field.in_force(drone.wanted);
        step.before[field.name] = field.in_force(drone.now);
        drone.restart = drone.restart || field.change == OrderField::Change::by_restart;
        drone.other_kind = drone.other_kind || field.type == OrderField::Type::kind;
    }
    if (const auto host = host_of(plan_, *drone.planned); drone.answer->place.host != host) {
        step.values["on"] = host;
        step.before["on"] = drone.answer->place.host;
        drone.restart = true;
    }
    if (drone.restart)
        step.what = SwarmStep::What::restart;
    return step;
}

/// The planned values that were not asked of the drone last, and what was; the default of those that the plan before
/// had. What a drone then made of a value, for example by rounding, another `set` would not change.
SwarmStep RunningDrones::parameters_of(const Running& drone, const Json& present)
{
    SwarmStep step{.what = SwarmStep::What::set, .drone = drone.planned->name};
    auto wanted = drone.planned->set;
    if (drone.before)
        for (const auto& [name, value] : drone.before->set.items())
            if (const auto* known = wanted.contains(name) ? nullptr : parameter(step.drone, name))
                wanted[name] = known->default_value;
    for (const auto& [name, value] : wanted.items()) {
        const auto now = present.find(name);
        if (now != present.end() && *now == value)
            continue;
        const auto* known = parameter(step.drone, name);  // a file may say "1.05" where the drone has the number
        if (known && now != present.end() && *now == checked_value(*known, value))
            continue;
        step.values[name] = value;
        if (now != present.end())
            step.before[name] = *now;
    }
    return step;
}

const ParameterInfo* RunningDrones::parameter(const std::string& drone, const std::string& name)
{
    if (described_ != drone)
        interface_ = application_.describe(drone);
    described_ = drone;
    return interface_.parameter(name);
}

/// What was set by hand stays, unless it is of another kind of drone.
void RunningDrones::add_restart(Running& drone, const Json& present, Differences& all)
{
    const auto& name = drone.planned->name;
    drone.now.set = running_set(application_, name, present);
    drone.wanted.set = drone.other_kind ? Json::object() : drone.now.set;
    if (drone.before) {
        drone.now.host = drone.before->host;
        for (const auto& [parameter, value] : drone.before->set.items())
            drone.wanted.set.erase(parameter);
    } else {
        drone.now.host = drone.planned->host;
    }
    drone.wanted.set.update(drone.planned->set);
    all.ran.drones.push_back(drone.now);
    *std::ranges::find(all.wanted.drones, name, &SwarmDrone::name) = drone.wanted;
    for (const auto& connection : present_.connections_of(name)) {
        const auto same = [&](const SwarmConnection& other) { return same_ends(connection, other); };
        if (std::ranges::any_of(all.ran.connections, same))
            continue;
        all.ran.connections.push_back(connection);
        if (!drone.other_kind || std::ranges::any_of(plan_.connections, same))
            all.kept.push_back(connection);
    }
}

std::vector<SwarmStep> RunningDrones::add_to(Differences& all)
{
    std::vector<Running> drones;
    std::vector<std::string> names;
    std::vector<SwarmStep> sets, left;
    for (const auto& planned : plan_.drones)
        if (const auto* answer = present_.find(planned.name)) {
            auto drone = compared(planned, *answer);
            if (auto step = fields_of(drone); !step.values.empty())
                (drone.shared ? left : all.steps).push_back(std::move(step));
            if (drone.restart || !planned.set.empty() || (drone.before && !drone.before->set.empty())) {
                names.push_back(planned.name);
                drones.push_back(std::move(drone));
            }
        }
    const auto answers = application_.asked(names);
    for (std::size_t i = 0; i < drones.size(); ++i) {
        if (answers[i].error)
            throw *answers[i].error;
        if (drones[i].restart && !drones[i].shared)
            add_restart(drones[i], answers[i].result, all);
        if (drones[i].other_kind)
            continue;
        if (auto step = parameters_of(drones[i], answers[i].result); !step.values.empty())
            (drones[i].shared ? left : sets).push_back(std::move(step));
    }
    std::ranges::move(sets, std::back_inserter(all.steps));
    return left;
}

std::vector<std::string> names_of(const SwarmPlan& plan, const SwarmPlan& before)
{
    std::vector<std::string> names;
    for (const auto* one : {&plan, &before})
        for (const auto& drone : one->drones)
            if (one == &plan || !plan.drone(drone.name))
                names.push_back(drone.name);
    return names;
}

/// A connection belongs to its receiver.
void add_connections(std::vector<SwarmStep>& steps, const SwarmPlan& plan, const Present& present)
{
    for (const auto& planned : plan.connections) {
        const auto* made = present.connection(planned);
        const auto& receiver = planned.to.drone;
        if (made
            && (made->options == planned.options || !may_change(plan, *plan.drone(receiver), *present.find(receiver))))
            continue;
        steps.push_back({.what = SwarmStep::What::connect,
                         .drone = planned.to.drone,
                         .connection = planned,
                         .replaced = made ? std::optional(made->options) : std::nullopt});
    }
}

/// A connection that a restart ends for good is not ended once more.
void add_ends(Differences& all, const SwarmPlan& plan, const SwarmPlan& before, const Present& present)
{
    const auto ends_anyway = [&](const SwarmConnection& old) {
        const auto same = [&](const SwarmConnection& other) { return same_ends(old, other); };
        return std::ranges::any_of(all.ran.connections, same) && std::ranges::none_of(all.kept, same);
    };
    for (const auto& old : before.connections) {
        const bool both_stay = plan.drone(old.from.drone) && plan.drone(old.to.drone);
        const bool planned = std::ranges::any_of(
            plan.connections, [&](const SwarmConnection& connection) { return same_ends(connection, old); });
        const auto* made = present.connection(old);
        if (both_stay && !planned && made && !ends_anyway(old)
            && may_change(plan, *plan.drone(old.to.drone), *present.find(old.to.drone)))
            all.steps.push_back({.what = SwarmStep::What::disconnect,
                                 .drone = old.to.drone,
                                 .connection = {old.from, old.to, made->options}});
    }
    for (const auto& old : before.drones)
        if (const auto* running = present.find(old.name); !plan.drone(old.name) && running && owns(plan, *running))
            all.steps.push_back({.what = SwarmStep::What::stop, .drone = old.name});
}

/// Says which drones of others are used, and what is not changed in them.
void tell_shared(const std::vector<SwarmStep>& left, const SwarmPlan& plan, const Present& present,
                 const std::function<void(const std::string& text)>& told)
{
    for (const auto& drone : plan.drones) {
        const auto* running = present.find(drone.name);
        if (!told || !running || may_change(plan, drone, *running))
            continue;
        std::string values;
        for (const auto& step : left)
            if (step.drone == drone.name)
                for (const auto& [name, value] : step.values.items())
                    values += " " + assignment(name, value);
        told(
            drone.name + " runs already, " + owner_text(*running) + ", and is used as it is"
            + (values.empty() ? "" : ", without" + values + "; to change it all the same: \"change_if_shared\": true"));
    }
}

}  // namespace

/// A drone has its name a moment before it can be met.
Present::Present(Application& application, const std::vector<std::string>& drones)
{
    constexpr auto patience_for_sockets = std::chrono::seconds(5);
    const auto end = event::Clock::now() + patience_for_sockets;
    for (auto asked = drones; !asked.empty();) {
        std::vector<std::string> begun;
        for (auto& answer : application.status(asked))
            if (!answer.error)
                answers_.emplace(answer.drone, std::move(answer));
            else if (answer.error->code() == Errc::unreachable && is_here(answer.place) && event::Clock::now() < end)
                begun.push_back(answer.drone);
            else if (answer.error->code() != Errc::not_found && is_here(answer.place))
                throw *answer.error;
        asked = std::move(begun);
        if (!asked.empty())
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
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
    for (const auto& input : receiver->status.inputs) {
        const auto dot = input.from.rfind('.');  // a drone's name may have one, too
        if (fits(connection.to, connection.to.drone, input.input)
            && fits(connection.from, input.from.substr(0, dot), input.from.substr(dot + 1)))
            return &input;
    }
    return nullptr;
}

std::vector<SwarmConnection> Present::connections_of(const std::string& drone) const
{
    std::vector<SwarmConnection> found;
    for (const auto& [receiver, answer] : answers_)
        for (const auto& input : answer.status.inputs) {
            const auto dot = input.from.rfind('.');
            const Endpoint from{input.from.substr(0, dot), input.from.substr(dot + 1)};
            if (from.drone == drone || receiver == drone)
                found.push_back({from, {receiver, input.input}, input.options});
        }
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
    const auto name = engine.settings.get<std::string>();
    return name.substr(name.rfind('@') + 1);
}

void require_same(const SwarmPlan& plan, const SwarmDrone& drone, const StatusAnswer& running)
{
    const std::string stop =
        (owns(plan, running) ? "" : "give yours another name, or ") + ("stop it: hivectl stop " + drone.name);
    if (!is_of_kind(running.status, drone.kind))
        throw Error(Errc::name_taken,
                    drone.name + " runs already and is a " + running_order(running, drone).kind + ", not a "
                        + drone.kind,
                    stop);
    if (const auto host = host_of(plan, drone); running.place.host != host)
        throw Error(Errc::name_taken, drone.name + " runs already on " + running.place.host + ", not on " + host, stop);
}

bool owns(const SwarmPlan& plan, const StatusAnswer& running) { return running.status.swarm == plan.name; }

std::string owner_text(const StatusAnswer& running)
{
    const auto& swarm = running.status.swarm;
    return "brought up by " + (swarm.empty() ? "no swarm" : "the swarm " + swarm);
}

DroneOrder running_order(const StatusAnswer& answer, const DroneOrder& otherwise)
{
    auto order = answer.status.order.value_or(otherwise);
    order.name = hive::drone_of(answer.drone);
    if (!answer.status.order || order.kind.empty())
        order.kind = answer.status.kind;
    order.host = answer.place.host;
    order.set = Json::object();
    order.restart = otherwise.restart;
    order.on_exception = token(answer.status.policy);
    order.halted = order.halted || answer.status.state == State::halted;
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
    const bool chosen = listens ? now.port >= transport::first_drone_port && now.port <= transport::last_drone_port
                                : now.port == transport::listen_address(running.listen).port;
    return meant.host == now.host && (meant.port == 0 ? chosen : meant.port == now.port);
}

Differences differences(Application& application, const SwarmPlan& plan, const SwarmPlan& before,
                        const std::function<void(const std::string& text)>& told)
{
    const Present present(application, names_of(plan, before));
    Differences all{.steps = {}, .wanted = plan, .ran = before};
    all.ran.name = plan.name;
    all.ran.drones.clear();
    all.ran.connections.clear();
    std::ranges::copy(plan.engines, std::back_inserter(all.ran.engines));
    for (const auto& drone : plan.drones)
        if (!present.find(drone.name))
            all.steps.push_back({.what = SwarmStep::What::start, .drone = drone.name});
    tell_shared(RunningDrones(application, plan, before, present).add_to(all), plan, present, told);
    add_connections(all.steps, plan, present);
    add_ends(all, plan, before, present);
    return all;
}

}  // namespace hive::swarm
