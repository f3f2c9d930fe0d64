// Checks that a new process can replace a drone, and starts it.
#include "directory.hpp"
#include "inquiry.hpp"
#include "successor_fit.hpp"

#include <hive/event/home.hpp>
#include <hive/platform/process.hpp>
#include <hive/program.hpp>
#include <hive/start.hpp>

#include <chrono>

namespace hive {
namespace {

using Clock = event::Clock;

Predecessor predecessor(Application& application, const event::Home& home, const std::string& drone)
{
    const auto reference = drone + "@" + Place::here;
    Predecessor before{
        .interface = application.describe(reference), .status = application.status(reference), .parameters = {}};
    const auto state = home.read_state(drone).value_or(Json::object());
    const Fields fields(state, "the state of " + drone);
    before.parameters = fields.has("parameters") ? fields.object("parameters") : Json::object();
    return before;
}

void require_stateless(const std::string& drone, const Interface& interface, const DroneOrder& order)
{
    if (interface.stateful && !order.lose_state)
        throw Error(Errc::refused, drone + " keeps state, which the new process would not have",
                    "to accept this: --lose-state");
}

/// Of the drone before, if the order names none.
void complete_kind(DroneOrder& order, const std::string& kind)
{
    if (!order.kind.empty())
        return;
    order.kind = kind;
    if (!program_of(kind))
        throw Error(Errc::not_found, order.name + " is a " + kind + ", and there is no program hive-" + kind,
                    "say what the new one is, if a Python file: --kind FILE.py, or kind=\"FILE.py\" in Python");
}

/// The new order, completed from the old one. Later settings of the old drone, and its ports, are in its saved state.
void complete(DroneOrder& order, const Predecessor& before)
{
    const auto old = before.status.order.value_or(DroneOrder{});
    for (const auto& field : order_fields())
        if (field.change != OrderField::Change::at_once && field.type != OrderField::Type::address
            && !field.is_said(order))
            field.copy(order, old);
    complete_kind(order, before.interface.kind);
}

/// Completes an order that replaces a drone of this machine, and checks it.
void make_fit(Application& application, DroneOrder& order)
{
    const event::Home home(application.home());
    auto before = predecessor(application, home, order.name);
    complete(order, before);
    for (const auto& [name, value] : order.set.items())
        before.parameters.erase(name);
    require_fit(application, before, interface_of(order.kind));
    require_stateless(order.name, before.interface, order);
    if (home.succession(order.name))
        throw Error(Errc::name_taken, order.name + " is being replaced already");
}

bool is_silence(const Error& error)
{
    return error.code() == Errc::timeout || error.code() == Errc::unreachable || error.code() == Errc::version_mismatch;
}

/// Another `replace --force` may have started a new process meanwhile, which must not be killed.
bool holds(const event::Home& home, const std::string& drone, std::int64_t pid)
{
    return home.alive(drone) && home.holder(drone) == pid;
}

/// The process of a drone of this machine that does not answer; 0: it answers, does not run, or was just replaced.
std::int64_t silent_process(Inquiry& inquiry, const event::Home& home, const std::string& drone)
{
    constexpr std::chrono::seconds timeout(3);
    const auto pid = home.holder(drone);
    inquiry.ask({drone + "@" + Place::here}, timeout);
    std::vector<StatusAnswer> answers;
    while ((answers = inquiry.take()).empty())
        inquiry.wait(Clock::now() + timeout, {});
    const auto* error = error_of(answers.front().status);
    return error && is_silence(*error) && holds(home, drone, pid) ? pid : 0;
}

/// Completes and checks an order for the time after the drone was killed. It is known by its saved state alone, which
/// a drone of another kind would not take.
void make_fit_for_restart(const event::Home& home, DroneOrder& order)
{
    const auto state = home.read_state(order.name).value_or(Json::object());
    const Fields fields(state, "the state of " + order.name);
    const auto kind = fields.has("kind") ? fields.text("kind") : kind_by_name(order.name).value_or("");
    if (order.kind.empty() && kind.empty())
        throw Error(Errc::not_found, order.name + " has saved no state, so its kind is unknown",
                    "say what it is: --kind KIND");
    complete_kind(order, kind);
    const auto next = interface_of(order.kind);
    if (fields.has("kind") && next.kind != kind)
        throw Error(Errc::refused, order.name + " does not answer, and is restarted as a " + kind + " only",
                    "to give up its parameters and connections: hivectl stop " + order.name
                        + ", and start another kind");
    require_stateless(order.name, next, order);
}

void kill(Inquiry& inquiry, const event::Home& home, const std::string& drone, std::int64_t pid,
          Clock::time_point until)
{
    if (holds(home, drone, pid))
        platform::kill_process(pid);
    while (holds(home, drone, pid)) {
        if (Clock::now() >= until)
            throw Error(Errc::timeout,
                        "process " + std::to_string(pid) + " of " + drone + " does not exit when killed");
        inquiry.wait(Clock::now() + std::chrono::milliseconds(2), {});
    }
}

/// @param forced  a drone of another machine may be silent: hivectl there kills it
std::int64_t pid_of(Application& application, const std::string& drone, bool forced)
{
    const auto answer = application.status(std::vector{drone}).at(0);
    const auto* error = error_of(answer.status);
    if (!error)
        return std::get<Status>(answer.status).pid;
    if (!is_silence(*error))
        throw *error;
    if (!forced)
        throw Error(error->code(), error->what(),
                    "kill it, and start a new one with its parameters and connections: hivectl replace " + drone
                        + " --force");
    return 0;
}

}  // namespace

Started replace(Application& application, StartOptions options)
{
    auto& order = options.drone;
    const auto place = application.place(order.name);
    if (!is_here(place) && place.ssh.empty())
        throw Error(Errc::refused,
                    place.drone + " at " + place.address
                        + " was not started through ssh, so only hivectl on its own machine can replace it",
                    "on that machine: hivectl replace " + place.drone
                        + "; for a drone of a swarm file, change the file: hivectl up FILE");
    std::int64_t killed = 0;
    if (order.force && is_here(place)) {
        const event::Home home(application.home());
        Inquiry inquiry(application);
        order.name = place.drone;
        killed = silent_process(inquiry, home, order.name);
        if (killed > 0) {
            make_fit_for_restart(home, order);
            kill(inquiry, home, order.name, killed, Clock::now() + options.limit);
        }
    }
    const auto before = killed > 0 ? killed : pid_of(application, order.name, order.force);
    order.name = place.drone;
    options.ssh = place.ssh;
    // A supervisor, or another replace, may be faster.
    options.if_missing = killed > 0 || (order.force && !is_here(place));
    if (killed == 0) {
        order.take_over_s = std::chrono::duration<double>(options.limit).count();
        if (is_here(place))
            make_fit(application, order);
    }
    auto started = start(application, options);
    if (started.found && !order.set.empty())
        application.set(order.name, order.set);
    if (before > 0)
        started.before = before;  // otherwise reported by the hivectl there
    return started;
}

}  // namespace hive
