// Carrying out the decisions of the receiver table.
#include <hive/event/outlet.hpp>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <limits>

namespace hive::event {

using protocol::PacketType;

namespace {

/// Switched off only by the tests that show what leases are for.
ReceiverTable::Defences defences() { return {.leases = std::getenv("HIVE_TEST_NO_LEASES") == nullptr}; }

}  // namespace

Outlet::Outlet(Port port, PacketType carrier, Encoder encoder, Hooks hooks)
    : port_(std::move(port)),
      carrier_(carrier),
      encoder_(std::move(encoder)),
      hooks_(std::move(hooks)),
      table_(defences()),
      dispatch_(encoder_,
                {.transmit = [this](const ReceiverTable::Send& send, const Emission& form) { transmit(send, form); },
                 .not_encoded = hooks_.not_encoded,
                 .on_encoder_thread = hooks_.on_encoder_thread,
                 .on_network_side = hooks_.on_network_side})
{
}

EncodingChoice Outlet::choice(const Link& link, const protocol::Registration& registration) const
{
    return {encoder_, registration, link.local() ? EncodingChoice::Way::one_machine : EncodingChoice::Way::network};
}

void Outlet::require_fit(const Link& link, const protocol::Registration& registration) const
{
    if (!types_fit(port_.type, registration.accepts))
        throw Error(Errc::type_mismatch, "output " + port_.name + " is " + port_.type + ", but " + registration.receiver
                                             + " takes " + registration.accepts);
    if (registration.stateful && !registration.options.group.empty())
        throw Error(Errc::refused,
                    registration.receiver + " keeps state between events, so it must see every one: it cannot share");
    (void)choice(link, registration);
}

std::size_t Outlet::receivers(const Link& link) const
{
    return static_cast<std::size_t>(std::distance(
        ids_.lower_bound({&link, 0}), ids_.upper_bound({&link, std::numeric_limits<std::uint16_t>::max()})));
}

void Outlet::add(const LinkPtr& link, std::uint16_t channel, const protocol::Registration& registration)
{
    const auto id = ++next_id_;
    ids_[{link.get(), channel}] = id;
    places_.emplace(id, Place{.link = link,
                              .channel = channel,
                              .encoding = choice(*link, registration),
                              .data = registration.options.delivery == Delivery::data});
    execute(table_.add(id, registration.receiver, registration.epoch, registration.options, Clock::now()));
}

void Outlet::request(const Link& link, std::uint16_t channel, const protocol::Request& request)
{
    if (const auto found = ids_.find({&link, channel}); found != ids_.end())
        execute(table_.request(found->second, request.epoch, request.id, request.done, Clock::now()));
}

bool Outlet::remove(const Link& link, std::uint16_t channel)
{
    const auto found = ids_.find({&link, channel});
    if (found == ids_.end())
        return false;
    forget(found, true);
    return true;
}

void Outlet::link_closed(const Link& link)
{
    for (auto it = ids_.lower_bound({&link, 0}); it != ids_.end() && it->first.first == &link;
         it = ids_.lower_bound({&link, 0}))
        forget(it, false);
}

void Outlet::forget(std::map<Key, ReceiverTable::Id>::iterator place, bool left)
{
    const auto id = place->second;
    ids_.erase(place);
    places_.erase(id);
    dispatch_.forget(id);
    execute(table_.remove(id, left, Clock::now()));
}

void Outlet::offer(EmissionPtr event, bool hold)
{
    ++produced_;
    last_emitted_us_ = wall_us();
    execute(table_.offer(std::move(event), hold, Clock::now()));
}

void Outlet::tick() { execute(table_.tick(Clock::now())); }

void Outlet::execute(const ReceiverTable::Decisions& decisions)
{
    for (const auto& send : decisions.sends) {
        const auto place = places_.find(send.receiver);
        if (place != places_.end())
            dispatch_.send(send, send.delivery == Delivery::data ? place->second.encoding.of(send.event->event())
                                                                 : std::string());
    }
    for (const auto& event : decisions.failed)
        hooks_.failed(event);
    refresh();
}

void Outlet::transmit(const ReceiverTable::Send& send, const Emission& form)
{
    Place& place = places_.at(send.receiver);
    const auto type = send.delivery == Delivery::notification ? PacketType::notification : carrier_;
    // The closure holds the event, and with it the receipt of a lossless input, until the bytes are with the system.
    // The table counts the size of the event, whatever the form has.
    const auto carriage = place.link->connection().send(
        form.packet(type, place.channel, send.share),
        [this, alive = std::weak_ptr(alive_), id = send.receiver, event = send.event](bool written) {
            if (!alive.expired() && written)
                execute(table_.written(id, event->size(), Clock::now()));
        });
    place.shared += carriage == transport::Carriage::reference ? 1 : 0;
    place.fallback += carriage == transport::Carriage::fallback ? 1 : 0;
}

void Outlet::refresh()
{
    const bool wanted = table_.wanted(), received = !places_.empty(), asked = table_.asked(),
               backlogged = table_.backlogged();
    const bool changed = wanted != wanted_ || received != received_ || asked != asked_ || backlogged != backlogged_;
    wanted_ = wanted;
    received_ = received;
    shares_ = std::ranges::any_of(
        places_, [](const auto& row) { return row.second.data && row.second.link->connection().shares(); });
    asked_ = asked;
    backlogged_ = backlogged;
    if (changed)
        hooks_.changed();
}

OutputStatus Outlet::status() const
{
    OutputStatus status{.name = port_.name,
                        .type = port_.type,
                        .produced = produced_,
                        .last_emitted_us = last_emitted_us_,
                        .why = received_ ? Reason::none : Reason::no_receiver};
    for (const auto& row : table_.rows()) {
        EdgeStatus edge{.receiver = row.receiver,
                        .group = row.id == 0,
                        .connected = row.id != 0,
                        .registration = row.epoch,
                        .options = row.options};
        if (const auto place = places_.find(row.id); place != places_.end()) {
            edge.encoding = place->second.encoding.word();
            edge.shared = place->second.shared;
            edge.fallback = place->second.fallback;
        }
        edge.events.came(row.counts.produced);
        edge.events.went(Fate::acknowledged, row.counts.delivered);
        edge.events.went(Fate::skipped, row.counts.skipped);
        edge.events.went(Fate::dropped, row.counts.dropped);
        edge.events.went(Fate::abandoned, row.counts.abandoned);
        status.edges.push_back(std::move(edge));
    }
    return status;
}

}  // namespace hive::event
