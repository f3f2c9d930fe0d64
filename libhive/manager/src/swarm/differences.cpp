// Compares drone by drone and connection by connection.
#include "differences.hpp"

#include "../directory.hpp"

#include <hive/event/clock.hpp>
#include <hive/name.hpp>

#include <algorithm>
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

/// The planned values of a running drone that were not asked of it last, and what was. What it then made of a value,
/// for example by rounding, is its own affair: another `set` would not change that.
class ParameterDifferences {
public:
    ParameterDifferences(Application& application, const std::vector<const SwarmDrone*>& drones)
        : application_(application), drones_(drones)
    {
    }

    void add_to(std::vector<SwarmStep>& steps)
    {
        std::vector<std::string> names;
        std::ranges::transform(drones_, std::back_inserter(names), &SwarmDrone::name);
        const auto answers = application_.asked(names);
        for (std::size_t i = 0; i < drones_.size(); ++i) {
            if (answers[i].error)
                throw *answers[i].error;
            if (auto step = step_of(*drones_[i], answers[i].result); !step.values.empty())
                steps.push_back(std::move(step));
        }
    }

private:
    SwarmStep step_of(const SwarmDrone& drone, const Json& present)
    {
        SwarmStep step{.what = SwarmStep::What::set, .drone = drone.name};
        for (const auto& [name, planned] : drone.set.items()) {
            const auto now = present.find(name);
            if (now != present.end() && (*now == planned || *now == as_taken(drone.name, name, planned)))
                continue;
            step.values[name] = planned;
            if (now != present.end())
                step.before[name] = *now;
        }
        return step;
    }

    /// A file may say "1.05" where the drone has the number.
    Json as_taken(const std::string& drone, const std::string& name, const Json& planned)
    {
        if (described_ != drone)
            interface_ = application_.describe(drone);
        described_ = drone;
        const auto* parameter = interface_.parameter(name);
        return parameter ? checked_value(*parameter, planned) : planned;
    }

    Application& application_;
    std::vector<const SwarmDrone*> drones_;
    std::string described_;
    Interface interface_;
};

std::vector<std::string> names_of(const SwarmPlan& plan, const SwarmPlan& before)
{
    std::vector<std::string> names;
    for (const auto* one : {&plan, &before})
        for (const auto& drone : one->drones)
            if (one == &plan || !plan.drone(drone.name))
                names.push_back(drone.name);
    return names;
}

bool may_change(const SwarmPlan& plan, const SwarmDrone& drone, const StatusAnswer& running)
{
    return drone.change_if_shared || owns(plan, running);
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

void add_ends(std::vector<SwarmStep>& steps, const SwarmPlan& plan, const SwarmPlan& before, const Present& present)
{
    for (const auto& old : before.connections) {
        const bool both_stay = plan.drone(old.from.drone) && plan.drone(old.to.drone);
        const bool planned = std::ranges::any_of(
            plan.connections, [&](const SwarmConnection& connection) { return same_ends(connection, old); });
        const auto* made = present.connection(old);
        if (both_stay && !planned && made && may_change(plan, *plan.drone(old.to.drone), *present.find(old.to.drone)))
            steps.push_back({.what = SwarmStep::What::disconnect,
                             .drone = old.to.drone,
                             .connection = {old.from, old.to, made->options}});
    }
    for (const auto& old : before.drones)
        if (const auto* running = present.find(old.name); !plan.drone(old.name) && running && owns(plan, *running))
            steps.push_back({.what = SwarmStep::What::stop, .drone = old.name});
}

/// Splits the changes: those of drones of another swarm are not made, but told.
void leave_shared(std::vector<SwarmStep>& steps, const SwarmPlan& plan, const Present& present,
                  const std::function<void(const std::string& text)>& told)
{
    for (const auto& drone : plan.drones) {
        const auto* running = present.find(drone.name);
        if (!running || may_change(plan, drone, *running))
            continue;
        std::string text = drone.name + " runs already, " + owner_text(*running) + ", and is used as it is";
        std::erase_if(steps, [&](const SwarmStep& step) {
            if (step.drone != drone.name)
                return false;
            std::string values;
            for (const auto& [name, value] : step.values.items())
                values += " " + assignment(name, value);
            text += ", without" + values + "; to change it all the same: \"change_if_shared\": true";
            return true;
        });
        if (told)
            told(text);
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
    if (running.status.kind != drone.kind)
        throw Error(Errc::name_taken,
                    drone.name + " runs already and is a " + running.status.kind + ", not a " + drone.kind, stop);
    if (const auto host = host_of(plan, drone); running.place.host != host)
        throw Error(Errc::name_taken, drone.name + " runs already on " + running.place.host + ", not on " + host, stop);
}

bool owns(const SwarmPlan& plan, const StatusAnswer& running) { return running.status.swarm == plan.name; }

std::string owner_text(const StatusAnswer& running)
{
    const auto& swarm = running.status.swarm;
    return "brought up by " + (swarm.empty() ? "no swarm" : "the swarm " + swarm);
}

std::vector<SwarmStep> differences(Application& application, const SwarmPlan& plan, const SwarmPlan& before,
                                   const std::function<void(const std::string& text)>& told)
{
    const Present present(application, names_of(plan, before));
    std::vector<SwarmStep> steps;
    std::vector<const SwarmDrone*> running;
    for (const auto& drone : plan.drones)
        if (const auto* answer = present.find(drone.name); !answer) {
            steps.push_back({.what = SwarmStep::What::start, .drone = drone.name});
        } else {
            require_same(plan, drone, *answer);
            if (!drone.set.empty())
                running.push_back(&drone);
        }
    ParameterDifferences(application, running).add_to(steps);
    leave_shared(steps, plan, present, told);
    add_connections(steps, plan, present);
    add_ends(steps, plan, before, present);
    return steps;
}

}  // namespace hive::swarm
