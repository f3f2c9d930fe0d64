// Answers connect and disconnect.
#include "wiring.hpp"

#include <algorithm>

namespace hive::service {

using event::Intake;
using event::IntakeSpec;
using event::Outcome;

void Wiring::on_connect(const event::Incoming& incoming)
{
    const Fields fields(incoming.header, "connect");
    const auto options = fields.has("options") ? connection_options(fields.object("options")) : ConnectionOptions{};
    connect(intake_spec(fields.object("from"), fields.name("input"), options),
            [answer = incoming.answer](const Outcome& outcome) { answer(outcome); });
}

void Wiring::on_disconnect(const event::Incoming& incoming)
{
    const Fields fields(incoming.header, "disconnect");
    const Fields from(fields.object("from"), "disconnect: from");
    const auto drone = from.name("drone"), output = from.name_or("output", ""), input = fields.name_or("input", "");
    const auto meant = [&](const IntakeSpec& spec) {
        return spec.sender == drone && (output.empty() || spec.output == output)
               && (input.empty() || spec.input == input);
    };
    std::size_t removed = 0;
    for (const auto& intake : std::vector(module_.intakes()))
        if (meant(intake->spec())) {
            inbox_.discard(intake->spec());
            module_.remove_intake(intake);
            ++removed;
        }
    if (removed == 0)
        throw Error(Errc::not_found,
                    module_.self().name + " receives nothing from " + drone + (output.empty() ? "" : "." + output));
    state_file_.remember();
    incoming.answer(Json{{"removed", removed}});
}

void Wiring::restore(const Json& connections)
{
    for (const auto& saved : connections)
        try {
            const Fields fields(saved, "saved connection");
            add_intake(
                intake_spec(fields.object("from"), fields.name("input"), connection_options(fields.object("options"))))
                ->start({});
        } catch (const Error& error) {
            reporter_.log(std::string("a saved connection is left out: ") + error.what());
        }
}

IntakeSpec Wiring::intake_spec(const Json& from, const std::string& input, const ConnectionOptions& options) const
{
    const Fields sender(from, "connect: from");
    const Port& port = port_named(declaration_.interface.inputs, module_.self().name, "input", input);
    const auto name = sender.name("drone");
    return {.sender = name,
            .output = sender.name("output"),
            .address = sender.has("address") ? transport::parse_address(sender.text("address")) : home_.address(name),
            .input = input,
            .receiver = module_.self().name + "." + input,
            .accepts = port.type,
            .stateful = declaration_.interface.stateful,
            .options = options};
}

std::shared_ptr<Intake> Wiring::add_intake(IntakeSpec spec)
{
    return module_.add_intake(std::move(spec), [this](Event&& event) { inbox_.arrived(std::move(event)); });
}

void Wiring::connect(IntakeSpec spec, event::OnOutcome on_outcome)
{
    const std::weak_ptr<Intake> weak = add_intake(std::move(spec));
    weak.lock()->start([this, weak, on_outcome = std::move(on_outcome)](const Outcome& outcome) {
        const auto self = weak.lock();
        if (std::holds_alternative<Error>(outcome)) {
            module_.remove_intake(self);
            return on_outcome(outcome);
        }
        replace_others(self);
        state_file_.remember();
        on_outcome(outcome);
    });
}

/// An input has one connection to an output: the newest.
void Wiring::replace_others(const std::shared_ptr<Intake>& intake)
{
    const auto& spec = intake->spec();
    for (const auto& other : std::vector(module_.intakes()))
        if (other != intake && other->spec().sender == spec.sender && other->spec().output == spec.output
            && other->spec().input == spec.input)
            module_.remove_intake(other);
}

}  // namespace hive::service
