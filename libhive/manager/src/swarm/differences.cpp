// Compares drone by drone and connection by connection.
#include "differences.hpp"

#include <hive/program.hpp>

#include <algorithm>
#include <iterator>

namespace hive::swarm {
namespace {

bool may_change(const SwarmPlan& plan, const SwarmDrone& drone, const StatusAnswer& running)
{
    return drone.change_if_shared || owns(plan, running);
}

/// Does the engine give it to each process that it starts?
bool is_enforced(const OrderField& field, std::string_view engine)
{
    return (field.type == OrderField::Type::amount && (engine == "systemd" || engine == "slurm"))
           || (field.name == "restart" && engine == "systemd");
}

/// Compares the running drones with the plan.
class RunningDrones {
public:
    RunningDrones(Application& application, const SwarmPlan& plan, const SwarmPlan& before, const Present& present)
        : application_(application), plan_(plan), before_(before), present_(present)
    {
    }

    /// @return  the changes that are not made because the drones belong to another swarm
    std::vector<SwarmStep> add_to(Differences& all);

private:
    struct Running {
        const SwarmDrone* planned;
        const SwarmDrone* before;  ///< null: not brought up, or by another swarm
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

/// A drone may differ in kind or machine only if the earlier plan had it so; any other belongs to another swarm.
RunningDrones::Running RunningDrones::compared(const SwarmDrone& planned, const StatusAnswer& answer)
{
    const auto& status = std::get<Status>(answer.status);
    const bool shared = !may_change(plan_, planned, answer);
    Running drone{.planned = &planned,
                  .before = shared ? nullptr : before_.drone(planned.name),
                  .answer = &answer,
                  .shared = shared};
    const bool known =
        drone.before && is_of_kind(status, drone.before->kind) && answer.place.host == host_of(before_, *drone.before);
    if (!known)
        require_same(plan_, planned, answer);
    auto otherwise = planned;
    for (const auto& field : order_fields())
        if (drone.before && is_enforced(field, plan_.engine_of(planned.host).name))
            field.copy(otherwise, *drone.before);
    drone.now = running_order(answer, otherwise);
    if (is_of_kind(status, planned.kind))
        drone.now.kind = planned.kind;
    drone.wanted = drone.now;
    drone.wanted.name = planned.name;
    drone.wanted.host = planned.host;
    drone.wanted.swarm = drone.now.swarm = status.swarm;
    for (const auto& field : order_fields())
        if (field.is_said(planned) || (drone.before && field.is_said(*drone.before))
            || runs_as_wanted(field, planned, drone.now,
                              answer.place))  // a port chosen on one machine does not apply to another
            field.copy(drone.wanted, planned);
    return drone;
}

/// One step for all fields: a restart or a change.
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

/// The planned values that differ from those last requested, with the old ones; the default for parameters that only
/// the earlier plan had. Compares requested values, since another `set` would not change how a drone adjusts a value,
/// for example by rounding.
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

/// Values set by hand stay, unless the kind of the drone changes.
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
        const auto* values = value_of(answers[i].result);
        if (!values) {
            const auto& error = std::get<Error>(answers[i].result);
            if (error.code() != Errc::timeout)
                throw error;
            all.silent.push_back({names[i], error});
            continue;
        }
        if (drones[i].restart && !drones[i].shared)
            add_restart(drones[i], *values, all);
        if (drones[i].other_kind)
            continue;
        if (auto step = parameters_of(drones[i], *values); !step.values.empty())
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
        if (present.silent().contains(planned.from.drone) || present.silent().contains(planned.to.drone))
            continue;
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

/// A connection that a restart has already ended for good is not disconnected again.
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

/// @param advice  empty: it is another swarm's to end it
Error unchanged(const std::string& drone, const std::string& advice)
{
    return {Errc::timeout, drone + " does not answer, so it and its connections are unchanged",
            advice.empty() ? "see: hivectl explain " + drone : advice};
}

void add_silent(Differences& all, const SwarmPlan& plan, const Present& present)
{
    for (const auto& [drone, swarm] : present.silent())
        if (plan.drone(drone))
            all.silent.push_back(
                {drone,
                 unchanged(drone,
                           swarm == plan.name ? "to kill and restart it: hivectl replace " + drone + " --force" : "")});
        else if (swarm == plan.name)
            all.silent.push_back({drone, unchanged(drone, "to stop it: hivectl stop " + drone)});
}

/// Reports which drones of other swarms are used, and what is left unchanged in them.
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
        told(drone.name + " runs already, " + owner_text(*running) + ", and is used as it is"
             + (values.empty() ? "" : ", without" + values + "; to change it anyway: \"change_if_shared\": true"));
    }
}

}  // namespace

Differences differences(Application& application, const SwarmPlan& plan, const SwarmPlan& before,
                        const std::function<void(const std::string& text)>& told)
{
    const Present present(application, names_of(plan, before));
    Differences all{.steps = {}, .wanted = plan, .ran = before};
    all.ran.name = plan.name;
    all.ran.drones.clear();
    all.ran.connections.clear();
    std::ranges::copy(plan.engines, std::back_inserter(all.ran.engines));
    add_silent(all, plan, present);
    for (const auto& drone : plan.drones)
        if (!present.find(drone.name) && !present.silent().contains(drone.name))
            all.steps.push_back({.what = SwarmStep::What::start, .drone = drone.name});
    tell_shared(RunningDrones(application, plan, before, present).add_to(all), plan, present, told);
    add_connections(all.steps, plan, present);
    add_ends(all, plan, before, present);
    return all;
}

}  // namespace hive::swarm
