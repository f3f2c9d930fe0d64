// The network side of a drone: what applications ask of it, answered while user code is busy.
#include "drone_core.hpp"

#include <hive/name.hpp>

#include <algorithm>
#include <unistd.h>

namespace hive {

using event::Incoming;
using event::Intake;
using event::IntakeSpec;
using event::Outcome;
using protocol::PacketType;

namespace {

/// A drone told to stop ends within this, whatever its code does.
constexpr auto last_grace = std::chrono::seconds(2);
/// For a `set`, whatever its deadline.
constexpr std::chrono::milliseconds most_patience = std::chrono::hours(24);

}  // namespace

void DroneCore::add_handlers()
{
    module_->handle(PacketType::describe, [this](const Incoming& incoming) { incoming.answer(to_json(interface)); });
    module_->handle(PacketType::status, [this](const Incoming& incoming) { on_status(incoming); });
    module_->handle(PacketType::get, [this](const Incoming& incoming) { on_get(incoming); });
    module_->handle(PacketType::set, [this](const Incoming& incoming) { on_set(incoming); });
    module_->handle(PacketType::put, [this](const Incoming& incoming) { on_put(incoming); });
    module_->handle(PacketType::connect, [this](const Incoming& incoming) { on_connect(incoming); });
    module_->handle(PacketType::disconnect, [this](const Incoming& incoming) { on_disconnect(incoming); });
    module_->handle(PacketType::halt, [this](const Incoming& incoming) { on_halt(incoming); });
    module_->handle(PacketType::resume, [this](const Incoming& incoming) { on_resume(incoming); });
    module_->handle(PacketType::stop, [this](const Incoming& incoming) {
        incoming.answer(Json::object());
        end(true);
    });
}

void DroneCore::on_get(const Incoming& incoming)
{
    const Fields fields(incoming.header, "get");
    std::vector<std::string> names;
    if (fields.has("names"))
        for (const auto& name : fields.array("names")) {
            if (!name.is_string())
                throw Error(Errc::malformed, "get: \"names\" must be an array of texts");
            names.push_back(name.get<std::string>());
        }
    incoming.answer(Json{{"parameters", parameters.values(names)}});
}

/// Of the parameters that `wanted` names.
Json DroneCore::present_values(const Json& wanted) const
{
    Json values = Json::object();
    for (const auto& [name, value] : wanted.items())
        values.update(parameters.values({name}));
    return values;
}

void DroneCore::on_set(const Incoming& incoming)
{
    const Fields fields(incoming.header, "set");
    const Json values = parameters.checked(fields.object("parameters"));
    const auto deadline =
        Clock::now()
        + std::min(most_patience,
                   std::chrono::milliseconds(fields.integer_or("deadline_ms", 0, max_json_integer, 5000)));
    if (fields.flag_or("check_only", false))
        return incoming.answer(Json{{"parameters", values}, {"previous", present_values(values)}});
    mailbox_.push([this, values, deadline, answer = incoming.answer] {
        if (Clock::now() >= deadline)
            return answer(
                Error(Errc::timeout, settings_.name + " was busy until the deadline had passed; nothing was set"));
        try {
            const Json before = present_values(values);
            apply(values);
            module_->post([this] { remember(); });
            answer(Json{{"parameters", present_values(values)}, {"previous", before}});
        } catch (const Error& error) {
            answer(Error(error.code() == Errc::failed ? Errc::refused : error.code(), error.what()));
        } catch (const std::exception& error) {
            answer(Error(Errc::refused, error.what()));
        }
        next_step_ = Clock::now();
    });
}

void DroneCore::on_put(const Incoming& incoming)
{
    const Fields fields(incoming.header, "put");
    const auto name = fields.name("input");
    const Port& input = port_named(interface.inputs, settings_.name, "input", name);
    if (halted_)
        throw Error(Errc::halted, settings_.name + " has halted", "let it go on: hivectl resume " + settings_.name);
    Event event;
    event.type = fields.text("type");
    if (!types_fit(event.type, input.type))
        throw Error(Errc::type_mismatch,
                    "the event is " + event.type + ", but " + settings_.name + "." + name + " takes " + input.type);
    event.identity = {.source = incoming.peer,
                      .epoch = epoch_,
                      .sequence = fields.integer("id", 0, max_json_integer),
                      .captured_us = event::wall_us(),
                      .monotonic_us = event::steady_us(),
                      .hops = {}};
    event.sender = incoming.peer;
    event.kind = "application";
    event.output = "put";
    event.input = name;
    if (fields.has("header"))
        event.header = fields.object("header");
    event.body = incoming.body;
    event.size = incoming.body.size();
    event.received = Clock::now();
    arrived(std::move(event), {});
    incoming.answer(Json::object());
}

IntakeSpec DroneCore::intake_spec(const Json& from, const std::string& input, const ConnectionOptions& options) const
{
    const Fields sender(from, "connect: from");
    const Port& port = port_named(interface.inputs, settings_.name, "input", input);
    const auto name = sender.name("drone");
    return {.sender = name,
            .output = sender.name("output"),
            .address = sender.has("address") ? transport::parse_address(sender.text("address")) : home_->address(name),
            .input = input,
            .receiver = settings_.name + "." + input,
            .accepts = port.type,
            .stateful = program_.stateful,
            .options = options};
}

void DroneCore::on_connect(Incoming incoming)
{
    const Fields fields(incoming.header, "connect");
    const auto options = fields.has("options") ? connection_options(fields.object("options")) : ConnectionOptions{};
    connect(intake_spec(fields.object("from"), fields.name("input"), options),
            [answer = incoming.answer](const Outcome& outcome) { answer(outcome); });
}

std::shared_ptr<Intake> DroneCore::add_intake(IntakeSpec spec)
{
    const auto weak = std::make_shared<std::weak_ptr<Intake>>();
    const auto intake =
        module_->add_intake(std::move(spec), [this, weak](Event&& event) { arrived(std::move(event), *weak); });
    *weak = intake;
    return intake;
}

void DroneCore::connect(IntakeSpec spec, event::OnOutcome on_outcome)
{
    const std::weak_ptr<Intake> weak = add_intake(std::move(spec));
    weak.lock()->start([this, weak, on_outcome = std::move(on_outcome)](const Outcome& outcome) {
        const auto self = weak.lock();
        if (std::holds_alternative<Error>(outcome)) {
            module_->remove_intake(self);
            return on_outcome(outcome);
        }
        const auto same = [&](const std::shared_ptr<Intake>& other) {
            return other != self && other->spec().sender == self->spec().sender
                   && other->spec().output == self->spec().output && other->spec().input == self->spec().input;
        };
        for (const auto& other : std::vector(module_->intakes()))
            if (same(other))
                module_->remove_intake(other);
        remember();
        on_outcome(outcome);
    });
}

void DroneCore::arrived(Event&& event, const std::weak_ptr<Intake>& weak)
{
    const bool fresh = filter_.first(event);
    const std::string input = event.input;
    const auto lost = fresh ? mailbox_.push(std::move(event)) : 0;
    const std::lock_guard lock(board_mutex_);
    auto& counts = board_.at[input];
    ++counts.received;
    counts.duplicates += fresh ? 0 : 1;
    counts.dropped += static_cast<std::int64_t>(lost);
    if (const auto intake = weak.lock())
        intake->lost += static_cast<std::int64_t>(lost);
}

void DroneCore::on_disconnect(const Incoming& incoming)
{
    const Fields fields(incoming.header, "disconnect");
    const Fields from(fields.object("from"), "disconnect: from");
    const auto drone = from.name("drone"), output = from.name_or("output", ""), input = fields.name_or("input", "");
    std::size_t removed = 0;
    for (const auto& intake : std::vector(module_->intakes())) {
        const auto& spec = intake->spec();
        if (spec.sender != drone || (!output.empty() && spec.output != output)
            || (!input.empty() && spec.input != input))
            continue;
        module_->remove_intake(intake);
        ++removed;
    }
    if (removed == 0)
        throw Error(Errc::not_found,
                    settings_.name + " receives nothing from " + drone + (output.empty() ? "" : "." + output));
    remember();
    incoming.answer(Json{{"removed", removed}});
}

/// A halt or resume that names a policy sets it, and does nothing else.
bool DroneCore::set_policy(const Incoming& incoming)
{
    const Fields fields(incoming.header, "policy");
    if (!fields.has("policy"))
        return false;
    const auto policy = from_token<ExceptionPolicy>(fields.text("policy"), "policy");
    {
        const std::lock_guard lock(board_mutex_);
        board_.policy = policy;
    }
    remember();
    incoming.answer(Json::object());
    return true;
}

void DroneCore::on_halt(const Incoming& incoming)
{
    if (set_policy(incoming))
        return;
    halted_ = true;
    module_->halt(true);
    {
        const std::lock_guard lock(board_mutex_);
        if (board_.state == State::idle)
            board_.state = State::halted;
    }
    mailbox_.nudge();
    incoming.answer(Json::object());
}

void DroneCore::on_resume(const Incoming& incoming)
{
    if (set_policy(incoming))
        return;
    mailbox_.push([this, answer = incoming.answer] {
        const auto old = mailbox_.discard_live();  // resume continues with the newest
        halted_ = false;
        set_state(State::idle);
        {
            const std::lock_guard lock(board_mutex_);
            if (!interface.inputs.empty())
                board_.at[interface.inputs.front().name].discarded += static_cast<std::int64_t>(old);
        }
        module_->halt(false);
        answer(Json::object());
    });
}

void DroneCore::end(bool forget)
{
    if (forget)
        home_->forget_state(settings_.name);
    if (stopping_.exchange(true))
        return;
    mailbox_.nudge();
    std::thread([grace = last_grace, home = *home_, name = settings_.name] {
        std::this_thread::sleep_for(grace);
        std::error_code ignored;
        std::filesystem::remove(home.path(name, ".sock"), ignored);
        ::_exit(0);
    }).detach();
}

void DroneCore::on_status(const Incoming& incoming)
{
    const Fields fields(incoming.header, "status");
    incoming.answer(to_json(page_of(status_now(), fields.integer_or("skip_edges", 0, max_json_integer, 0))));
}

Status DroneCore::status_now()
{
    Board board;
    {
        const std::lock_guard lock(board_mutex_);
        board = board_;
    }
    const auto busy_for = board.state == State::busy ? event::microseconds(Clock::now() - board.busy_since) : 0;
    Status status{.name = settings_.name,
                  .kind = interface.kind,
                  .pid = ::getpid(),
                  .epoch = epoch_,
                  .state = stopping_ ? State::stopping : board.state,
                  .policy = board.policy,
                  .condition = board.condition,
                  .uptime_us = event::microseconds(Clock::now() - started_),
                  .busy_us = board.busy_us + busy_for,
                  .busy_for_us = busy_for,
                  .callback = board.callback,
                  .why = halted_ ? Reason::halted : Reason::none,
                  .matching = matching_status(board),
                  .last_exception = board.last_exception};
    for (const auto& outlet : module_->outlets())
        status.outputs.push_back(outlet.status());
    add_inputs(status, board);
    return status;
}

/// What was counted for an input stands with its first connection, or in `left` when there is none.
void DroneCore::add_inputs(Status& status, const Board& board) const
{
    auto counted = board.at;
    for (const auto& intake : module_->intakes()) {
        auto& row = status.inputs.emplace_back(intake->status());
        const auto counts = counted.extract(row.input);
        row.processed = counts ? counts.mapped().processed : 0;
        row.abandoned = counts ? counts.mapped().abandoned : 0;
        row.duplicates = counts ? counts.mapped().duplicates : 0;
        row.discarded = counts ? counts.mapped().discarded : 0;
        row.queued = counts ? static_cast<std::int64_t>(mailbox_.events()) : 0;
    }
    for (auto& [input, counts] : counted) {
        counts.input = input;
        status.left.push_back(std::move(counts));
    }
}

}  // namespace hive
