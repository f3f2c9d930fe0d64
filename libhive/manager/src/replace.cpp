// Checks that a new process can replace a drone, and starts it.
#include "directory.hpp"
#include "successor_fit.hpp"

#include <hive/event/home.hpp>
#include <hive/program.hpp>
#include <hive/start.hpp>

#include <chrono>

namespace hive {
namespace {

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

}  // namespace

Started replace(Application& application, StartOptions options)
{
    auto& order = options.drone;
    const auto place = application.place(order.name);
    if (!is_here(place) && place.ssh.empty())
        throw Error(Errc::refused,
                    place.drone + " at " + place.address + " was not started through ssh, so it is replaced there",
                    "do it there: hivectl replace " + place.drone);
    const auto before = application.status(order.name).pid;
    order.name = place.drone;
    order.take_over_s = std::chrono::duration<double>(options.limit).count();
    options.ssh = place.ssh;
    if (is_here(place))
        make_fit(application, order);
    auto started = start(application, options);
    started.before = before;
    return started;
}

}  // namespace hive
