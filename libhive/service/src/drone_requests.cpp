// The network side of a drone: what applications ask of it, answered while user code is busy.
#include "drone_core.hpp"

#include <hive/name.hpp>
#include <hive/protocol/requests.hpp>

#include <algorithm>
#include <unistd.h>

namespace hive {

using event::Incoming;
using event::Intake;
using event::IntakeSpec;
using event::Outcome;
using protocol::PacketType;

namespace {

/// So that a status with all its rows fits into one header.
constexpr std::size_t most_receivers_listed = 128;
/// A drone told to stop ends within this, whatever its code does.
constexpr auto last_grace = std::chrono::seconds(2);

std::vector<std::string> port_names(const std::vector<Port>& ports)
{
    std::vector<std::string> names;
    for (const auto& port : ports)
        names.push_back(port.name);
    return names;
}

}  // namespace

void DroneCore::add_handlers()
{
    module_->handle(PacketType::describe, [this](const Incoming& incoming) { incoming.answer(to_json(interface)); });
    module_->handle(PacketType::status, [this](const Incoming& incoming) { incoming.answer(status_now()); });
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
    const auto set = protocol::set_from_json(incoming.header);
    const Json values = parameters.checked(set.parameters);
    if (set.check_only)
        return incoming.answer(Json{{"parameters", values}, {"previous", present_values(values)}});
    mailbox_.push([this, values, asked = incoming.asked, answer = incoming.answer] {
        if (!asked->begin())
            return;  // its deadline has answered, or is about to
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
    const Port* input = interface.input(name);
    if (!input)
        throw Error(Errc::not_found, settings_.name + " has no input " + name);
    if (halted_)
        throw Error(Errc::halted, settings_.name + " has halted; resume it: hivectl resume " + settings_.name);
    Event event;
    event.type = fields.text("type");
    if (!types_fit(event.type, input->type))
        throw Error(Errc::type_mismatch,
                    "the event is " + event.type + ", but " + settings_.name + "." + name + " takes " + input->type);
    event.identity = {.source = incoming.peer,
                      .epoch = incoming.peer_epoch,
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

IntakeSpec DroneCore::intake_spec(const protocol::Connect& connect) const
{
    const Port* port = interface.input(connect.input);
    if (!port) {
        const auto near = nearest(connect.input, port_names(interface.inputs));
        throw Error(Errc::not_found, settings_.name + " has no input " + connect.input
                                         + (near.empty() ? "" : "; did you mean " + near + "?"));
    }
    const auto address =
        connect.address.empty() ? home_->address(connect.drone) : transport::parse_address(connect.address);
    if (address == home_->address(settings_.name))
        throw Error(Errc::invalid_argument, settings_.name + " cannot receive its own output " + connect.output
                                                + ": each event would bring forth the next");
    return {.sender = connect.drone,
            .output = connect.output,
            .address = address,
            .input = connect.input,
            .receiver = settings_.name + "." + connect.input,
            .accepts = port->type,
            .stateful = program_.stateful,
            .options = connect.options};
}

void DroneCore::on_connect(Incoming incoming)
{
    connect(intake_spec(protocol::connect_from_json(incoming.header)),
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
        replace_earlier(self);
        remember();
        on_outcome(outcome);
    });
}

/// Those of the same pair that were asked for before; what was asked for later will replace this one in its turn.
void DroneCore::replace_earlier(const std::shared_ptr<Intake>& intake)
{
    const auto same = [&](const std::shared_ptr<Intake>& other) {
        return other->spec().sender == intake->spec().sender && other->spec().output == intake->spec().output
               && other->spec().input == intake->spec().input;
    };
    for (const auto& other : std::vector(module_->intakes())) {
        if (other == intake)
            return;
        if (same(other))
            module_->remove_intake(other);
    }
}

void DroneCore::arrived(Event&& event, const std::weak_ptr<Intake>& weak)
{
    const bool fresh = filter_.first(event);
    const auto lost = fresh ? mailbox_.push(std::move(event)) : 0;
    const std::lock_guard lock(board_mutex_);
    ++board_.received;
    board_.duplicates += fresh ? 0 : 1;
    board_.dropped += static_cast<std::int64_t>(lost);
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
            board_.discarded += static_cast<std::int64_t>(old);
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

Json DroneCore::status_now()
{
    Json outputs = Json::array(), inputs = Json::array();
    std::size_t rows = most_receivers_listed;
    for (const auto& outlet : module_->outlets())
        outputs.push_back(outlet.status(rows));
    Board board;
    {
        const std::lock_guard lock(board_mutex_);
        board = board_;
    }
    for (const auto& intake : module_->intakes()) {
        Json row = intake->status();
        row["abandoned"] = board.abandoned_at[intake->spec().input];
        inputs.push_back(std::move(row));
    }
    const bool busy = board.state == State::busy;
    const auto busy_for = busy ? event::microseconds(Clock::now() - board.busy_since) : 0;
    Json json{{"name", settings_.name},
              {"kind", interface.kind},
              {"pid", ::getpid()},
              {"epoch", epoch_},
              {"state", token(stopping_ ? State::stopping : board.state)},
              {"condition", board.condition},
              {"policy", token(board.policy)},
              {"uptime_us", event::microseconds(Clock::now() - started_)},
              {"busy_us", board.busy_us + busy_for},
              {"busy_for_us", busy_for},
              {"callback", board.callback},
              {"queued", mailbox_.events()},
              {"events",
               {{"received", board.received},
                {"processed", board.processed},
                {"abandoned", board.abandoned},
                {"duplicates", board.duplicates},
                {"discarded", board.discarded},
                {"dropped", board.dropped}}},
              {"outputs", outputs},
              {"inputs", inputs}};
    if (!matchings.empty())
        json["matching"] = matching_status(board);
    if (!board.last_exception.is_null())
        json["last_exception"] = board.last_exception;
    return json;
}

}  // namespace hive
