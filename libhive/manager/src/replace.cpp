// Checks that a new process can replace a drone, and starts it.
#include "directory.hpp"
#include "inquiry.hpp"
#include "known_program.hpp"
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

void require_stateless(const Predecessor& before, const DroneOrder& order)
{
    if (before.interface.stateful && !order.lose_state)
        throw Error(Errc::refused, before.status.name + " keeps state, which the new process would not have",
                    "to accept this: --lose-state");
}

/// The new order, completed from the old one. Later settings of the old drone, and its ports, are in its saved state.
void complete(DroneOrder& order, const Predecessor& before)
{
    const auto old = before.status.order.value_or(DroneOrder{});
    for (const auto& field : order_fields())
        if (field.change != OrderField::Change::at_once && field.type != OrderField::Type::address
            && !field.is_said(order))
            field.copy(order, old);
    if (!order.kind.empty())
        return;
    order.kind = before.interface.kind;
    if (!program_of(order.kind))
        throw Error(Errc::not_found,
                    before.status.name + " is a " + order.kind + ", and there is no program hive-" + order.kind,
                    "say what the new one is, if a Python file: --kind FILE.py, or kind=\"FILE.py\" in Python");
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
    require_stateless(before, order);
    if (home.succession(order.name))
        throw Error(Errc::name_taken, order.name + " is being replaced already");
}

bool is_silence(const Error& error)
{
    return error.code() == Errc::timeout || error.code() == Errc::unreachable || error.code() == Errc::version_mismatch;
}

/// Kills the process of a drone of this machine that does not answer. @return its id; 0: the drone answers
std::int64_t kill_if_silent(Application& application, const event::Home& home, const std::string& drone,
                            Clock::time_point until)
{
    constexpr std::chrono::seconds patience(3);
    Inquiry inquiry(application);
    inquiry.ask({drone + "@" + Place::here}, patience);
    std::vector<StatusAnswer> answers;
    while ((answers = inquiry.take()).empty())
        inquiry.wait(Clock::now() + patience, {});
    const auto& error = answers.front().error;
    const auto pid = home.holder(drone);
    if (!error || !is_silence(*error) || pid <= 0 || !home.alive(drone))
        return 0;
    platform::kill_process(pid);
    while (home.alive(drone)) {
        if (Clock::now() >= until)
            throw Error(Errc::timeout,
                        "process " + std::to_string(pid) + " of " + drone + " does not exit when killed");
        inquiry.wait(Clock::now() + std::chrono::milliseconds(2), {});
    }
    return pid;
}

/// @param forced  a drone of another machine may be silent: hivectl there kills it
std::int64_t pid_of(Application& application, const std::string& drone, bool forced)
{
    const auto answer = application.status(std::vector{drone}).at(0);
    if (!answer.error)
        return answer.status.pid;
    if (!is_silence(*answer.error))
        throw *answer.error;
    if (!forced)
        throw Error(answer.error->code(), answer.error->what(),
                    "kill it, and start a new one with its parameters and connections: hivectl replace " + drone
                        + " --force");
    return 0;
}

/// Starts a drone that was killed: its parameters and connections are in its saved state.
Started start_again(Application& application, StartOptions options)
{
    if (options.drone.kind.empty())
        options.drone.kind = known_program(application, options.drone.name).kind;
    options.if_missing = true;  // its supervisor may be faster
    return start(application, std::move(options));
}

}  // namespace

Started replace(Application& application, StartOptions options)
{
    auto& order = options.drone;
    const auto place = application.place(order.name);
    if (!is_here(place) && place.ssh.empty())
        throw Error(Errc::refused,
                    place.drone + " at " + place.address + " was not started through ssh, so it is replaced there",
                    "do it there: hivectl replace " + place.drone);
    std::int64_t before = 0;
    if (order.force && is_here(place))
        before =
            kill_if_silent(application, event::Home(application.home()), place.drone, Clock::now() + options.limit);
    const bool killed = before != 0;
    if (!killed)
        before = pid_of(application, order.name, order.force);
    order.name = place.drone;
    options.ssh = place.ssh;
    if (!killed) {
        order.take_over_s = std::chrono::duration<double>(options.limit).count();
        if (is_here(place))
            make_fit(application, order);
    }
    auto started = killed ? start_again(application, options) : start(application, options);
    started.before = before;
    return started;
}

}  // namespace hive
