// What a drone emits: identities, bodies in shared memory, the way to the network side.
#include "drone_core.hpp"

#include <algorithm>

namespace hive {
namespace {

constexpr int most_handover = 64;  ///< emitted events that the network side has not yet seen, per output

/// A time as an event may tell it; 0 is unknown.
std::int64_t telling(std::int64_t time_us) { return time_us >= 0 && time_us <= max_json_integer ? time_us : 0; }

}  // namespace

Loan DroneCore::loan(std::size_t bytes)
{
    if (module_)
        if (auto shared = module_->pool().loan(bytes))
            return std::move(*shared);
    auto memory = std::make_shared_for_overwrite<std::byte[]>(bytes);
    return {std::span(memory.get(), bytes), memory};
}

bool DroneCore::wanted(std::size_t output) const
{
    const auto* outlet = outputs_[output]->outlet;
    return outlet && outlet->wanted();
}

bool DroneCore::received(std::size_t output) const
{
    const auto* outlet = outputs_[output]->outlet;
    return outlet && outlet->received();
}

bool DroneCore::asked(std::size_t output) const
{
    const Slot& slot = *outputs_[output];
    return slot.outlet && slot.handover == 0 && slot.outlet->asked();
}

Identity DroneCore::fresh_identity(std::size_t output, std::int64_t captured_us, bool lossless) const
{
    const auto age_us = event::wall_us() - captured_us;
    return {.source = settings_.name,
            .epoch = epoch_,
            .sequence = outputs_[output]->sequence + 1,
            .captured_us = telling(captured_us),
            .monotonic_us = telling(event::steady_us() - age_us),
            .lossless = lossless,
            .hops = {}};
}

/// The identity of what is emitted for the present set.
Identity DroneCore::inherited(Slot& slot) const
{
    Identity identity = event::identity_of(*current_);
    identity.part = slot.part++;
    // It waited from when it was complete; what its earlier events waited for is told by the hops of the last.
    const auto complete = std::ranges::max_element(*current_, {}, &Event::received)->received;
    identity.hops.push_back({settings_.name, event::microseconds(current_since_ - complete),
                             event::microseconds(Clock::now() - current_since_)});
    return identity;
}

void DroneCore::emit(std::size_t output, std::optional<Identity> begun, Json header,
                     const std::function<std::optional<Body>()>& body, std::string type)
{
    const Port& port = port_to_emit(output, header);
    Slot& slot = *outputs_[output];
    const bool begins = begun || !current_;
    Event event;
    if (begun) {
        event.identity = std::move(*begun);
    } else if (current_) {
        event.identity = inherited(slot);
        if (event.identity.lossless)
            event.receipt = event::receipt_of(*current_);
    } else {
        event.identity = fresh_identity(output, event::wall_us(), false);
    }
    event.type = type.empty() ? port.type.substr(0, port.type.find(',')) : std::move(type);
    event.header = std::move(header);
    auto made = body();
    const bool complete = made.has_value();
    event.body = std::move(made).value_or(Body());
    event.size = event.body.size();
    send(output, std::move(event), complete);
    if (begins)
        ++slot.sequence;  // what could not be sent leaves no gap
}

void DroneCore::fail(std::size_t output, std::int64_t captured_us, bool lossless, const Error& error)
{
    auto identity = fresh_identity(output, captured_us, lossless);
    ++outputs_[output]->sequence;
    throw CaptureFailed(error, std::move(identity));
}

const Port& DroneCore::port_to_emit(std::size_t output, const Json& header) const
{
    const Port& port = interface.outputs[output];
    if (!module_)
        throw Error(Errc::invalid_argument, "output " + port.name + ": nothing can be emitted before run()");
    if (!header.is_object())
        throw Error(Errc::invalid_argument, "output " + port.name + ": the header of an event must be a JSON object");
    return port;
}

void DroneCore::repeat(std::size_t output, Event event)
{
    static_cast<void>(port_to_emit(output, event.header));
    event.receipt.reset();
    event.input.clear();
    const bool complete = !event.body.empty() || event.size == 0;
    if (complete)
        event.size = event.body.size();
    send(output, std::move(event), complete);
}

void DroneCore::send(std::size_t output, Event event, bool complete)
{
    Slot& slot = *outputs_[output];
    const Port& port = interface.outputs[output];
    event.sender = settings_.name;
    event.kind = interface.kind;
    event.output = port.name;
    if (slot.outlet->shares())
        event.body = module_->pool().copied_in(event.body);
    if (event.body.size() > protocol::Limits{}.body)
        throw Error(Errc::too_large, "output " + port.name + ": a body of " + std::to_string(event.body.size())
                                         + " bytes, limit " + std::to_string(protocol::Limits{}.body));
    auto emission = std::make_shared<const event::Emission>(std::move(event), complete);
    {
        std::unique_lock lock(handover_mutex_);
        handover_less_.wait(lock, [&] { return slot.handover < most_handover; });
        ++slot.handover;
    }
    module_->loop().perform([this, &slot, emission = std::move(emission)] {
        module_->emit(*slot.outlet, emission);
        {
            const std::lock_guard lock(handover_mutex_);
            --slot.handover;
        }
        handover_less_.notify_one();
        if (slot.outlet->asked())
            mailbox_.nudge();
    });
}

}  // namespace hive
