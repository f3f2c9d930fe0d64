// Makes events with identities, and posts them to the network side.
#include "emitter.hpp"

#include <hive/event/ticket.hpp>

#include <algorithm>

namespace hive::service {

using event::Clock;

namespace {

/// A time within the limits of an event's header; 0 is unknown.
std::int64_t telling(std::int64_t time_us) { return time_us >= 0 && time_us <= max_json_integer ? time_us : 0; }

}  // namespace

std::size_t Emitter::add_output(Port port, Encoder encoder)
{
    port.encodings = encoder.encodings;
    interface_.outputs.push_back(std::move(port));
    outputs_.push_back(&slots_.emplace_back());
    outputs_.back()->encoder = std::move(encoder);
    return outputs_.size() - 1;
}

void Emitter::attach(event::Module& module)
{
    module_ = &module;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        outputs_[i]->epoch = self_.epoch;
        outputs_[i]->outlet =
            &module.add_outlet(interface_.outputs[i], protocol::PacketType::event, std::move(outputs_[i]->encoder));
    }
}

void Emitter::begin(const Set& set)
{
    set_ = &set;
    begun_ = Clock::now();
    for (auto* slot : outputs_)
        slot->part = 0;
}

Loan Emitter::loan(std::size_t bytes) const
{
    if (module_)
        if (auto shared = module_->pool().loan(bytes))
            return std::move(*shared);
    auto memory = std::make_shared_for_overwrite<std::byte[]>(bytes);
    return {std::span(memory.get(), bytes), memory};
}

bool Emitter::wanted(std::size_t output) const
{
    const auto* outlet = outputs_[output]->outlet;
    return outlet && outlet->wanted();
}

bool Emitter::needs_body(std::size_t output) const
{
    const auto has_receiver = [](const Slot* slot) { return slot->outlet && slot->outlet->wanted(); };
    const bool waits = set_ && set_->front().identity.lossless && std::ranges::none_of(outputs_, has_receiver);
    return waits || wanted(output);
}

bool Emitter::received(std::size_t output) const
{
    const auto* outlet = outputs_[output]->outlet;
    return outlet && outlet->received();
}

bool Emitter::asked(std::size_t output) const
{
    const Slot& slot = *outputs_[output];
    return slot.outlet && slot.handed_over == 0 && slot.outlet->asked();
}

Identity Emitter::fresh_identity(std::size_t output, std::int64_t captured_us, bool lossless) const
{
    const auto age_us = event::wall_us() - captured_us;
    return {.source = self_.name,
            .epoch = outputs_[output]->epoch,
            .sequence = outputs_[output]->sequence + 1,
            .captured_us = telling(captured_us),
            .monotonic_us = telling(event::steady_us() - age_us),
            .lossless = lossless,
            .hops = {}};
}

bool Emitter::backlogged(std::size_t output) const
{
    const Slot& slot = *outputs_[output];
    return slot.outlet && (slot.handed_over > 0 || slot.outlet->backlogged());
}

/// A result of the current set has the identity of its first event, and the tickets of lossless ones.
void Emitter::inherit(Event& event, Slot& slot) const
{
    event.identity = event::identity_of(*set_);
    event.identity.part = slot.part++;
    // The set waited since it was complete; the hops of its last event have the waiting time of the earlier ones.
    const auto complete = std::ranges::max_element(*set_, {}, &Event::received)->received;
    event.identity.hops.push_back(
        {self_.name, event::microseconds(begun_ - complete), event::microseconds(Clock::now() - begun_)});
    if (event.identity.lossless)
        event.ticket = event::causes(*set_);
}

void Emitter::emit(std::size_t output, std::optional<Identity> begun, Json header,
                   const std::function<std::optional<Body>()>& body, std::string type)
{
    const Port& port = port_to_emit(output, header);
    const bool begins = begun || !set_;
    Event event;
    if (begun)
        event.identity = std::move(*begun);
    else if (set_)
        inherit(event, *outputs_[output]);
    else
        event.identity = fresh_identity(output, event::wall_us(), false);
    event.type = type.empty() ? port.type.substr(0, port.type.find(',')) : std::move(type);
    event.header = std::move(header);
    auto made = body();
    const bool complete = made.has_value();
    event.body = std::move(made).value_or(Body());
    event.size = event.body.size();
    send(output, std::move(event), complete);
    if (begins)
        ++outputs_[output]->sequence;  // an event that could not be sent leaves no gap
}

void Emitter::fail(std::size_t output, std::int64_t captured_us, bool lossless, const Error& error)
{
    auto identity = fresh_identity(output, captured_us, lossless);
    ++outputs_[output]->sequence;
    throw CaptureFailed(error, std::move(identity));
}

const Port& Emitter::port_to_emit(std::size_t output, const Json& header) const
{
    const Port& port = interface_.outputs[output];
    if (!module_)
        throw Error(Errc::invalid_argument, "output " + port.name + ": emit() was called before run()");
    if (!header.is_object())
        throw Error(Errc::invalid_argument, "output " + port.name + ": the header of an event must be a JSON object");
    return port;
}

void Emitter::repeat(std::size_t output, Event event)
{
    static_cast<void>(port_to_emit(output, event.header));
    event.ticket = {};
    event.input.clear();
    const bool complete = !event.body.empty() || (event.sized && event.size == 0);
    if (complete)
        event.size = event.body.size();
    send(output, std::move(event), complete);
}

void Emitter::end(std::size_t output, const std::string& text)
{
    begin_source(output);
    perform(*outputs_[output], [text](event::Outlet& outlet) { outlet.end(text); });
}

void Emitter::begin_source(std::size_t output)
{
    Slot& slot = *outputs_[output];
    slot.epoch = std::max(slot.epoch + 1, event::wall_us());
    slot.sequence = 0;
    perform(slot, [](event::Outlet& outlet) { outlet.go_on(); });
}

void Emitter::end_all(const std::string& text, const std::function<bool()>& still)
{
    for (auto* slot : outputs_)
        perform(*slot, [text, still](event::Outlet& outlet) {
            if (still())
                outlet.end(text);
        });
}

/// If user code emits faster than the network side sends, its thread runs the network side meanwhile.
void Emitter::await_room(Slot& slot)
{
    constexpr int most = 64;
    if (slot.handed_over >= most)
        module_->loop().wait(Clock::time_point::max(), [&] { return slot.handed_over < most; });
}

/// On the network side, after all earlier emissions.
void Emitter::perform(Slot& slot, std::function<void(event::Outlet&)> task)
{
    if (!module_)
        return;  // no receivers yet
    await_room(slot);
    ++slot.handed_over;
    module_->loop().perform([&slot, task = std::move(task)] {
        task(*slot.outlet);
        --slot.handed_over;
    });
}

void Emitter::send(std::size_t output, Event&& event, bool complete)
{
    Slot& slot = *outputs_[output];
    const Port& port = interface_.outputs[output];
    event.sender = self_.name;
    event.kind = self_.kind;
    event.output = port.name;
    if (slot.outlet->shares())
        event.body = module_->pool().copied_in(event.body);
    if (constexpr auto most = protocol::Limits{}.body; event.body.size() > most)
        require_at_most("output " + port.name + ": a body", event.body.size(), most);
    std::optional<Share> own;
    if (event.identity.lossless)
        own = Share{.of = self_.name + "." + port.name,
                    .epoch = self_.epoch,
                    .turn = ++slot.given,
                    .part = event.identity.part,
                    .each = slot.outlet->fans_out()};
    auto emission = std::make_shared<const event::Emission>(std::move(event), complete, std::move(own));
    await_room(slot);
    ++slot.handed_over;
    module_->loop().perform([this, &slot, emission = std::move(emission)] {
        module_->emit(*slot.outlet, emission);
        --slot.handed_over;
        mailbox_.nudge();  // main may wait for asked() or for the end of backlogged()
    });
}

}  // namespace hive::service
