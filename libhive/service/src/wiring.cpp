// Answers connect and disconnect, and passes ends on.
#include "wiring.hpp"

#include <hive/event/ticket.hpp>

#include <algorithm>

namespace hive::service {

using event::Intake;
using event::IntakeSpec;
using event::Outcome;

namespace {

constexpr std::size_t max_connections = 1024;

bool same_ends(const IntakeSpec& one, const IntakeSpec& other)
{
    return one.sender == other.sender && one.output == other.output && one.input == other.input;
}

/// "image from camera.image"
std::string ends_of(const IntakeSpec& spec) { return spec.input + " from " + spec.sender + "." + spec.output; }

/// The host of "192.0.2.7:50012" or "[2001:db8::7]:50012"; empty: the peer is on this machine.
std::string host_of(const std::string& peer_place)
{
    const auto colon = peer_place.rfind(':');
    if (colon == std::string::npos)
        return {};
    const auto host = peer_place.substr(0, colon);
    return host.starts_with('[') ? host.substr(1, host.size() - 2) : host;
}

/// The asker does not know which address of a sender that listens at all addresses this drone can reach: use the
/// address from which it asks.
std::string dialable(const std::string& text, const std::string& asker)
{
    if (text.empty())
        return text;
    auto address = transport::parse_address(text);
    if (address.scheme != transport::Address::Scheme::tcp || !address.is_everywhere())
        return text;
    const auto host = host_of(asker);
    address.host = !host.empty() ? host : address.host == "::" ? "::1" : "127.0.0.1";
    return to_text(address);
}

}  // namespace

void Wiring::on_connect(const event::Incoming& incoming)
{
    auto asked = protocol::connect_from_json(incoming.header);
    asked.address = dialable(asked.address, incoming.peer_place);
    auto spec = intake_spec(asked);
    if (incoming.role != Role::owner && spec.address.scheme == transport::Address::Scheme::unix_socket
        && spec.address != home_.address(asked.drone))
        throw Error(Errc::not_permitted,
                    to_text(spec.address) + " is not in the home of " + module_.self().name
                        + ", and over the network a drone is connected to drones of its home, or to tcp:// addresses",
                    "connect it on that machine");
    connect(std::move(spec), incoming.asked->deadline(),
            [answer = incoming.answer](const Outcome& outcome) { answer(outcome); });
}

void Wiring::on_disconnect(const event::Incoming& incoming)
{
    const auto what = protocol::disconnect_from_json(incoming.header);
    const auto meant = [&](const IntakeSpec& spec) {
        return spec.sender == what.drone && (what.output.empty() || spec.output == what.output)
               && (what.input.empty() || spec.input == what.input);
    };
    std::size_t removed = 0;
    for (const auto& intake : std::vector(module_.intakes()))
        if (meant(intake->spec())) {
            mailbox_.discard(came_over(*intake));
            module_.remove_intake(intake);
            ++removed;
        }
    pass_end_on();
    if (removed == 0)
        throw Error(Errc::not_found, module_.self().name + " receives nothing from " + what.drone
                                         + (what.output.empty() ? "" : "." + what.output));
    state_file_.remember();
    incoming.answer(Json{{"removed", removed}});
}

void Wiring::begin(const std::vector<protocol::Connect>& connections)
{
    for (const auto& connect : connections)
        begin(intake_spec(connect));
}

/// No asker waits for the answer, so it is logged.
void Wiring::begin(IntakeSpec spec)
{
    const auto intake = add_intake(std::move(spec));
    intake->start([this, ends = ends_of(intake->spec()), weak = std::weak_ptr(intake)](const Outcome& outcome) {
        const auto* error = std::get_if<Error>(&outcome);
        const auto waiting = weak.lock();
        if (error && waiting && !waiting->refusal() && error->code() != Errc::stopped)
            reporter_.log(LogLevel::info, "waiting for the sender of " + ends + ": " + error->what());
    });
}

void Wiring::restore(const Json& connections)
{
    for (const auto& saved : connections)
        try {
            auto spec = intake_spec(protocol::connect_from_json(saved));
            const auto same = [&](const auto& intake) { return same_ends(intake->spec(), spec); };
            if (std::ranges::none_of(module_.intakes(), same))
                begin(std::move(spec));
        } catch (const Error& error) {
            reporter_.log(LogLevel::warning, std::string("ignored a saved connection: ") + error.what());
        }
}

IntakeSpec Wiring::intake_spec(const protocol::Connect& connect) const
{
    const Port& port = port_named(declaration_.interface.inputs, module_.self().name, "input", connect.input);
    const auto& self = module_.self().name;
    const auto address =
        connect.address.empty() ? home_.address(connect.drone) : transport::parse_address(connect.address);
    if (address == home_.address(self))
        throw Error(Errc::invalid_argument,
                    self + " cannot receive its own output " + connect.output + ": each event would cause another");
    return {.sender = connect.drone,
            .output = connect.output,
            .address = address,
            .input = connect.input,
            .receiver = self + "." + connect.input,
            .accepts = port.type,
            .stateful = declaration_.interface.stateful,
            .options = connect.options};
}

std::shared_ptr<Intake> Wiring::add_intake(IntakeSpec spec)
{
    const auto own = std::make_shared<std::weak_ptr<Intake>>();
    const auto changed = [this, own, said = std::make_shared<Said>()] {
        if (const auto intake = own->lock(); intake && !intake->stopped())
            say(*intake, *said);
        pass_end_on();
    };
    const auto intake = module_.add_intake(
        std::move(spec), [this](Event&& event) { mailbox_.push(std::move(event)); }, changed);
    *own = intake;
    pass_end_on();  // as long as this input may not have ended, the outputs must not end
    return intake;
}

/// Logs each error once, until it changes. A refused connection is retried, since the sender may be restarted as
/// another drone.
void Wiring::say(const Intake& intake, Said& said) const
{
    const auto ends = ends_of(intake.spec());
    const auto line = [&]() -> std::pair<LogLevel, std::string> {
        if (intake.connected())
            return {LogLevel::debug, "connected " + ends};
        if (const auto refusal = intake.refusal())
            return {LogLevel::warning, "refused " + ends + ": " + refusal->what()};
        if (!said.connected)
            return {LogLevel::info, said.line};
        if (intake.ended())  // the sender has ended
            return {LogLevel::debug, "closed " + ends};
        return {LogLevel::warning, "lost " + ends + "; reconnecting"};
    }();
    if (line.second != said.line)
        module_.log_about(line.first, intake.spec().sender, line.second);
    said = {line.second, intake.connected()};
}

void Wiring::connect(IntakeSpec spec, event::Clock::time_point until, event::OnOutcome on_outcome)
{
    const auto earlier = earlier_ones(spec);
    const auto newest = earlier.empty() ? nullptr : earlier.back();
    if (newest && newest->awaited() && newest->spec() == spec)
        return newest->await(std::move(on_outcome), until);  // two have asked for the same
    const bool only_options = newest && newest->connected() && newest->spec().address == spec.address;
    if (only_options && newest->spec().options.group.empty() && spec.options.group.empty())
        return newest->change(
            spec.options,
            [this, on_outcome = std::move(on_outcome)](const Outcome& outcome) {
                state_file_.remember();
                on_outcome(outcome);
            },
            until);
    if (earlier.empty() && module_.intakes().size() >= max_connections)
        throw Error(Errc::refused, module_.self().name + " has " + std::to_string(max_connections) + " connections");
    for (const auto& intake : earlier)
        intake->hold();
    const std::weak_ptr<Intake> weak = add_intake(std::move(spec));
    const auto answered = [this, weak, earlier, on_outcome = std::move(on_outcome)](const Outcome& outcome) {
        const auto self = weak.lock();
        if (std::holds_alternative<Error>(outcome)) {
            module_.remove_intake(self);
            pass_end_on();
            for (const auto& intake : earlier)
                intake->let_go_on();
            state_file_.remember();  // the change may have been saved during the attempt
            return on_outcome(outcome);
        }
        replace_earlier(self, outcome);
        state_file_.remember();
        on_outcome(outcome);
    };
    weak.lock()->start(answered, until);
}

std::vector<std::shared_ptr<Intake>> Wiring::earlier_ones(const IntakeSpec& spec) const
{
    auto all = module_.intakes();
    std::erase_if(all, [&](const auto& intake) { return !same_ends(intake->spec(), spec); });
    return all;
}

/// An input has one connection to an output: the newest. A later request replaces this one, but a caller that wanted
/// the same has what it wanted.
void Wiring::replace_earlier(const std::shared_ptr<Intake>& intake, const Outcome& outcome)
{
    for (const auto& other : std::vector(module_.intakes())) {
        if (other == intake)
            return;
        if (!same_ends(other->spec(), intake->spec()))
            continue;
        if (!other->spec().options.group.empty())
            mailbox_.discard(came_over(*other));
        if (other->spec() == intake->spec())
            other->answer(outcome);
        module_.remove_intake(other);
    }
    pass_end_on();
}

/// The outputs end when all inputs have ended, and continue when there is work again, which revokes the end at their
/// receivers.
void Wiring::pass_end_on()
{
    const bool before = end_.text().has_value();
    if (!end_.look(module_.intakes(), module_.leaving()))
        return;
    if (before)
        for (auto& outlet : module_.outlets())
            if (outlet.carrier() == protocol::PacketType::event)
                outlet.go_on();
    if (const auto text = end_.text())
        mailbox_.push([this, text] { worker_.inputs_ended(*text, [this, text] { return end_.text() == text; }); });
}

}  // namespace hive::service
