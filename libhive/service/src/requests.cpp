// Dispatches requests; put, halt, resume and stop are answered here.
#include "requests.hpp"

#include <hive/event_text.hpp>
#include <hive/protocol/requests.hpp>

namespace hive::service {

using event::Incoming;
using protocol::PacketType;

Requests::Requests(Parts parts)
    : parts_(std::move(parts)),
      state_file_(parts_.home, parts_.module, parts_.declaration, parts_.board, parts_.listening, parts_.reporter),
      wiring_(parts_.declaration, parts_.home, parts_.module, parts_.mailbox, parts_.worker, state_file_,
              parts_.reporter),
      parameters_({.parameters = parts_.declaration.parameters,
                   .board = parts_.board,
                   .module = parts_.module,
                   .mailbox = parts_.mailbox,
                   .worker = parts_.worker,
                   .state_file = state_file_,
                   .remote_operator = parts_.order.remote_operator}),
      status_(parts_.declaration, parts_.board, parts_.mailbox, parts_.module, parts_.listening, parts_.order)
{
    add_handlers();
    parts_.module.on_subscribers = [this] { state_file_.subscribers_changed(); };
}

void Requests::add_handlers()
{
    const auto handle = [this](PacketType type, auto answer) { parts_.module.handle(type, std::move(answer)); };
    handle(PacketType::describe,
           [this](const Incoming& incoming) { incoming.answer(to_json(parts_.declaration.interface)); });
    handle(PacketType::status, [this](const Incoming& incoming) {
        const auto skip = Fields(incoming.header, "status").integer_or("skip", 0, max_json_integer, 0);
        incoming.answer(to_json(status_.page(skip, incoming.role)));
    });
    handle(PacketType::get, [this](const Incoming& incoming) { parameters_.on_get(incoming); });
    handle(PacketType::set, [this](const Incoming& incoming) { parameters_.on_set(incoming); });
    handle(PacketType::connect, [this](const Incoming& incoming) { wiring_.on_connect(incoming); });
    handle(PacketType::disconnect, [this](const Incoming& incoming) { wiring_.on_disconnect(incoming); });
    handle(PacketType::put, [this](const Incoming& incoming) { on_put(incoming); });
    handle(PacketType::forget, [this](const Incoming& incoming) { on_forget(incoming); });
    handle(PacketType::halt, [this](const Incoming& incoming) { on_halt(incoming); });
    handle(PacketType::resume, [this](const Incoming& incoming) { on_resume(incoming); });
    handle(PacketType::stop, [this](const Incoming& incoming) { on_stop(incoming); });
}

/// The receivers of the last run count, and return soon; the command line counts only for a drone that was never
/// connected, or that returns with new settings.
void Requests::expect(const Json& state, const std::vector<protocol::Expect>& expected)
{
    const auto known = subscribers_from(state, parts_.reporter);
    parts_.module.expect(known, event::Clock::now() + event::Subscription::kept_for);
    if (state.contains("subscribers") && !is_to_return(state))
        return;
    std::vector<event::Subscriber> others;
    for (const auto& expect : expected)
        if (std::ranges::none_of(known, [&](const event::Subscriber& one) {
                return one.output == expect.output && one.receiver == expect.receiver && !one.dormant;
            }))
            others.push_back({.output = expect.output, .receiver = expect.receiver, .group = expect.group});
    parts_.module.expect(others, std::nullopt);
}

void Requests::restore(const Json& state, const std::vector<protocol::Connect>& wished,
                       const std::vector<protocol::Expect>& expected)
{
    expect(state, expected);
    wiring_.begin(wished);
    wiring_.restore(state.value("connections", Json::array()));
    state_file_.remember();
}

namespace {

/// An event of another drone that is sent again keeps its identity; no sender waits for its outcome.
Event put_event(const protocol::Put& put, const Incoming& incoming)
{
    if (put.again) {
        Event event = event_from_text(to_text(incoming.header), incoming.body);
        event.identity.lossless = false;
        event.identity.shares.clear();
        return event;
    }
    Event event;
    event.type = put.type;
    event.identity = {.source = incoming.peer,
                      .epoch = incoming.peer_epoch,
                      .sequence = Fields(incoming.header, "put").integer("id", 0, max_json_integer),
                      .captured_us = event::wall_us(),
                      .monotonic_us = event::steady_us(),
                      .hops = {}};
    event.sender = incoming.peer;
    event.kind = "application";
    event.output = "put";
    event.header = put.header;
    event.body = incoming.body;
    event.size = incoming.body.size();
    return event;
}

}  // namespace

void Requests::on_put(const Incoming& incoming)
{
    const auto put = protocol::put_from_json(incoming.header);
    const auto& name = parts_.module.self().name;
    const Port& input = port_named(parts_.declaration.interface.inputs, name, "input", put.input);
    if (parts_.board.halted())
        throw Error(Errc::halted, name + " has halted", "resume it: hivectl resume " + name);
    Event event = put_event(put, incoming);
    if (!types_fit(event.type, input.type))
        throw Error(Errc::type_mismatch,
                    "the event is " + event.type + ", but " + name + "." + input.name + " takes " + input.type);
    event.input = input.name;
    event.received = event::Clock::now();
    parts_.module.accept(std::move(event), [this](Event&& arrived) { parts_.mailbox.push(std::move(arrived)); });
    incoming.answer(Json::object());
}

/// Stops waiting for a receiver that is gone.
void Requests::on_forget(const Incoming& incoming)
{
    const auto forget = protocol::forget_from_json(incoming.header);
    if (!forget.output.empty() && forget.output != "exceptions")
        port_named(parts_.declaration.interface.outputs, parts_.module.self().name, "output", forget.output);
    const auto removed = parts_.module.forget(forget.receiver, forget.output);
    if (removed == 0)
        throw Error(Errc::not_found, parts_.module.self().name + " keeps nothing for " + forget.receiver);
    incoming.answer(Json{{"removed", removed}});
}

/// A halt or resume with a policy only sets the policy.
bool Requests::set_policy(const Incoming& incoming)
{
    const Fields fields(incoming.header, "policy");
    if (!fields.has("policy"))
        return false;
    parts_.board.policy(from_token<ExceptionPolicy>(fields.text("policy"), "policy"));
    state_file_.remember();
    incoming.answer(Json::object());
    return true;
}

void Requests::on_halt(const Incoming& incoming)
{
    if (set_policy(incoming))
        return;
    parts_.worker.halt(incoming.peer + " (" + incoming.peer_place + ")");
    incoming.answer(Json::object());
}

void Requests::on_resume(const Incoming& incoming)
{
    if (set_policy(incoming))
        return;
    parts_.mailbox.push([&worker = parts_.worker, answer = incoming.answer] {
        worker.resume();
        answer(Json::object());
    });
}

void Requests::on_stop(const Incoming& incoming)
{
    const Fields fields(incoming.header, "stop");
    if (const auto owner = parts_.board.values().swarm; fields.has("swarm") && fields.name("swarm") != owner)
        throw Error(Errc::refused, parts_.module.self().name + " was brought up by "
                                       + (owner.empty() ? "no swarm" : "the swarm " + owner));
    const bool returns = fields.flag_or("returns", false), successor = fields.flag_or("successor", false);
    if (returns && successor)
        throw Error(Errc::malformed, "stop: successor and returns exclude each other");
    if (returns) {
        incoming.answer(Json::object());
        if (parts_.hand_over(ShutdownWatchdog::stop_timeout))
            state_file_.remember_to_return();
        return;
    }
    if (!successor) {
        incoming.answer(Json::object());
        return parts_.end();
    }
    if (const auto& name = parts_.module.self().name; !parts_.home.succession(name))
        throw Error(Errc::refused, "no process waits to take over " + name);
    incoming.answer(Json{{"halted", parts_.board.halted()}});
    parts_.hand_over(ShutdownWatchdog::hand_over_timeout);
}

}  // namespace hive::service
