// Carries out the decisions of the receiver table.
#include <hive/event/outlet.hpp>
#include <hive/name.hpp>
#include <hive/platform/process.hpp>
#include <hive/protocol/defended.hpp>

#include <algorithm>
#include <iterator>
#include <limits>
#include <set>

namespace hive::event {

using protocol::PacketType;

namespace {

ReceiverTable::Defences defences() { return {.leases = defended("leases"), .places = defended("places")}; }

/// The clock of leases and kept places: the steady clock; the wall clock in a twin of a test.
Clock::time_point lease_now()
{
    static const bool steady = defended("steady-clock");
    return steady ? Clock::now() : Clock::time_point(platform::WallClock::now().time_since_epoch());
}

/// The peer dialed in with the viewers' key.
bool is_guest(const Link& link) { return link.credentials().role == Role::viewer; }

/// Is the receiver's name unique? An application may register several times under one name, and a viewer's name is not
/// verified.
bool is_unique(const Link& link) { return link.peer().kind != "application" && !is_guest(link); }

/// A viewer's claims are ignored: it has no place to return to, and its own counters.
protocol::Registration as_guest(protocol::Registration registration)
{
    registration.receiver += " (viewer)";
    registration.place = 0;
    registration.taken.reset();
    return registration;
}

/// May a receiver that was lost come back? A drone may be started again; an application that died does not.
bool returns(const Link& link, Fate how) { return link.peer().kind != "application" || how != Fate::lost_killed; }

}  // namespace

Outlet::Outlet(const protocol::Hello& drone, Port port, PacketType carrier, Encoder encoder, Hooks hooks)
    : port_(std::move(port)),
      carrier_(carrier),
      encoder_(std::move(encoder)),
      hooks_(std::move(hooks)),
      table_(drone.name + "." + port_.name, drone.epoch, defences()),
      dispatch_(encoder_, {.transmit = [this](const Send& send, const Emission& form) { transmit(send, form); },
                           .not_encoded = hooks_.not_encoded,
                           .on_encoder_thread =
                               [this](ReceiverId receiver, std::function<void()> job) {
                                   const auto& peer = places_.at(receiver).link->connection().peer();
                                   hooks_.on_encoder_thread(peer, std::move(job));
                               },
                           .on_network_side = hooks_.on_network_side,
                           .end = [this](ReceiverId receiver) { transmit_end(receiver); }})
{
}

EncodingChoice Outlet::choice(const Link& link, const protocol::Registration& registration) const
{
    return {port_, registration, link.local() ? EncodingChoice::Way::one_machine : EncodingChoice::Way::network};
}

void Outlet::require_fit(const Link& link, const protocol::Registration& registration) const
{
    if (!types_fit(port_.type, registration.accepts))
        throw Error(Errc::type_mismatch, "output " + port_.name + " is " + port_.type + ", but " + registration.receiver
                                             + " takes " + registration.accepts);
    if (registration.stateful && !registration.options.group.empty())
        throw Error(Errc::refused,
                    registration.receiver + " keeps state between events, so it must see every one: it cannot share");
    const auto& name = link.peer().name;
    if (!belongs_to(registration.receiver, name))
        throw Error(Errc::not_permitted, name + " may not receive as " + in_quotes(registration.receiver));
    (void)choice(link, registration);
    require_few_encodings(link, registration);
    if (is_guest(link))
        require_modest(registration);
}

/// A viewer is passive: it gets no work, and causes no encoding that no other receiver wants.
void Outlet::require_modest(const protocol::Registration& registration) const
{
    if (!registration.options.group.empty())
        throw Error(Errc::not_permitted, "a viewer may not share work", "use the members' key: hivectl key show");
    if (const auto& encoding = registration.options.encoding;
        !encoding.empty() && std::ranges::find(port_.encodings, encoding, &Encoding::word) == port_.encodings.end())
        throw Error(Errc::not_permitted, "a viewer may not request the encoding " + in_quotes(encoding),
                    "leave it out");
}

/// Each encoding is made once for all its receivers; a peer that asked for many would delay the others.
void Outlet::require_few_encodings(const Link& link, const protocol::Registration& registration) const
{
    constexpr std::size_t most_encodings = 4;
    std::set<std::string> encodings{registration.options.encoding};
    for (const auto& [id, place] : places_)
        if (place.link.get() == &link)
            encodings.insert(place.encoding.word());
    encodings.erase("");
    encodings.erase(EncodingChoice::as_it_is);
    if (!registration.options.encoding.empty() && encodings.size() > most_encodings)
        throw Error(Errc::refused, "output " + port_.name + " encodes its events in " + std::to_string(most_encodings)
                                       + " ways at most for one peer");
}

std::size_t Outlet::receivers(const Link& link) const
{
    return static_cast<std::size_t>(std::distance(
        ids_.lower_bound({&link, 0}), ids_.upper_bound({&link, std::numeric_limits<std::uint16_t>::max()})));
}

void Outlet::add(const LinkPtr& link, std::uint16_t channel, const protocol::Registration& told,
                 const std::function<void(const Welcome&)>& confirm)
{
    const bool guest = is_guest(*link);
    const auto registration = guest ? as_guest(told) : told;
    const auto id = ++next_id_;
    Newcomer newcomer{.id = id,
                      .receiver = registration.receiver,
                      .epoch = registration.epoch,
                      .options = registration.options,
                      .place = registration.place,
                      .taken = registration.taken,
                      .held = registration.held,
                      .tried = guest                     ? 0
                               : registration.tried != 0 ? registration.tried
                                                         : registration.epoch,
                      .run = link->peer().epoch,
                      .unique = is_unique(*link),
                      .guest = guest,
                      .local = link->local()};
    if (const auto before = table_.standing(newcomer)) {
        // Over one connection packets keep their order. Over two an earlier registration, given up by then, may come
        // after the one that was made in its place, and would push that out.
        if (places_.at(*before).registration > registration.epoch)
            throw Error(Errc::refused, registration.receiver + " has registered again since");
        newcomer.drains = places_.at(*before).link == link;
    }
    Decisions decisions;
    const auto welcome = table_.add(newcomer, lease_now(), decisions);
    if (welcome.ends)
        detach(std::ranges::find(ids_, *welcome.ends, [](const auto& row) { return row.second; }));
    ids_[{link.get(), channel}] = id;
    places_.emplace(id, Place{.link = link,
                              .channel = channel,
                              .receiver = registration.receiver,
                              .registration = registration.epoch,
                              .encoding = choice(*link, registration),
                              .data = registration.options.delivery == Delivery::data,
                              .stateful = registration.stateful});
    confirm(welcome);
    execute(decisions);
}

void Outlet::request(const Link& link, std::uint16_t channel, const protocol::Request& request)
{
    const auto found = ids_.find({&link, channel});
    if (found == ids_.end())
        return;
    Decisions decisions;
    const auto id = found->second;
    table_.request(id, request.epoch, {request.id, request.worked, request.done}, request.back, lease_now(), decisions);
    execute(decisions);
    const auto place = places_.find(id);
    if (place == places_.end() || place->second.registration != request.epoch || request.end <= place->second.question)
        return;
    place->second.answer_until = Clock::now() + std::chrono::milliseconds(request.within_ms);
    if (std::exchange(place->second.question, request.end) == place->second.answered)
        answer(id);
}

/// Handles one question of a receiver at a time. The answer is sent after all the receiver's events.
void Outlet::answer(ReceiverId receiver)
{
    const auto& asking = places_.at(receiver);
    const auto left = std::chrono::floor<std::chrono::milliseconds>(asking.answer_until - Clock::now());
    hooks_.make_sure(left, [this, alive = std::weak_ptr(alive_), receiver, number = asking.question] {
        if (alive.expired())
            return;
        const auto place = places_.find(receiver);
        if (place == places_.end())
            return;
        place->second.answered = number;
        dispatch_.end(receiver);
        if (place->second.question > number)
            answer(receiver);
    });
}

bool Outlet::remove(const Link& link, std::uint16_t channel)
{
    const auto found = ids_.find({&link, channel});
    if (found == ids_.end())
        return false;
    Decisions decisions;
    table_.leave(detach(found), lease_now(), decisions);
    execute(decisions);
    return true;
}

void Outlet::link_closed(const Link& link, Fate how)
{
    Decisions decisions;
    const auto first = [&] { return ids_.lower_bound({&link, 0}); };
    for (auto it = first(); it != ids_.end() && it->first.first == &link; it = first()) {
        Place place = places_.at(it->second);
        table_.lose(detach(it), how, returns(link, how), lease_now(), decisions);
        tell_failed_at(std::exchange(decisions.failed_at, {}), place, how);
    }
    execute(decisions);
}

/// Sends an event in this receiver's encoding.
void Outlet::tell_failed_at(const std::vector<FailedAt>& failed, Place& place, Fate how)
{
    if (!place.data || is_guest(*place.link) || place.link->peer().kind == "application")
        return;
    Failing failing{.link = *place.link, .receiver = place.receiver, .how = how, .events = {}};
    for (const auto& [receiver, event, worked] : failed)
        if (place.stateful || !worked) {
            const auto form = event->rendition(place.encoding.of(event->event()));
            failing.events.push_back(form ? form : event);
        }
    if (!failing.events.empty())
        hooks_.failed_at(failing);
}

/// Detaches this registration from its link; the table still has it.
ReceiverId Outlet::detach(std::map<Key, ReceiverId>::iterator place)
{
    const auto id = place->second;
    ids_.erase(place);
    places_.erase(id);
    dispatch_.forget(id);
    return id;
}

void Outlet::offer(const EmissionPtr& event, bool hold)
{
    ++produced_;
    last_emitted_us_ = wall_us();
    lossless_ = event->lossless();
    Decisions decisions;
    table_.offer(event, hold, lease_now(), decisions);
    execute(decisions);
}

void Outlet::end(const std::string& text)
{
    end_ = {};
    end_.add(text);
    Decisions decisions;
    table_.end(lease_now(), decisions);
    execute(decisions);
}

void Outlet::go_on()
{
    Decisions decisions;
    table_.go_on(decisions);
    execute(decisions);
}

void Outlet::release_held()
{
    table_.release_held();
    refresh();
}

void Outlet::expect(const Subscriber& subscriber, std::optional<Clock::time_point> until)
{
    table_.expect(subscriber, until);
    if (subscriber.pid != 0)
        expected_[subscriber.receiver] = subscriber.pid;
    refresh();
}

/// 0: not an application on this machine.
std::int64_t Outlet::pid_of(const std::string& application) const
{
    for (const auto& [id, place] : places_)
        if (place.receiver == application && place.link->local() && place.link->peer().kind == "application")
            return place.link->peer().pid;
    const auto expected = expected_.find(application);
    return expected != expected_.end() ? expected->second : 0;
}

std::vector<Subscriber> Outlet::subscribers() const
{
    auto list = table_.subscribers();
    for (auto& each : list) {
        each.output = port_.name;
        each.pid = pid_of(each.receiver);
    }
    return list;
}

std::size_t Outlet::forget(const std::string& drone)
{
    Decisions decisions;
    const auto registered = table_.registered(drone);
    for (const auto id : registered) {
        const auto& place = places_.at(id);
        send_end(place, {.text = {}, .disconnected = true});
        table_.leave(detach(ids_.find({place.link.get(), place.channel})), lease_now(), decisions);
    }
    const auto forgotten = registered.size() + table_.forget(drone, decisions);
    execute(decisions);
    return forgotten;
}

void Outlet::tick()
{
    Decisions decisions;
    for (const auto& [application, pid] : expected_)
        if (platform::process_ends(pid))
            table_.forget(application, decisions);
    table_.tick(lease_now(), decisions);
    execute(decisions);
}

void Outlet::execute(const Decisions& decisions)
{
    for (const auto receiver : decisions.revoked)
        if (places_.contains(receiver))
            dispatch_.end(receiver);
    for (const auto& send : decisions.sends) {
        const auto place = places_.find(send.receiver);
        if (place != places_.end())
            dispatch_.send(send, send.delivery == Delivery::data ? place->second.encoding.of(send.event->event())
                                                                 : std::string());
    }
    for (const auto receiver : decisions.ends)
        if (places_.contains(receiver))
            dispatch_.end(receiver);
    for (const auto& event : decisions.failed)
        hooks_.failed(event);
    for (const auto& failed : decisions.failed_at)
        if (const auto place = places_.find(failed.receiver); place != places_.end())
            tell_failed_at({failed}, place->second, Fate::passed_on);
    refresh();
}

void Outlet::transmit(const Send& send, const Emission& form)
{
    Place& place = places_.at(send.receiver);
    const auto type = send.delivery == Delivery::notification ? PacketType::notification : carrier_;
    // The closure holds the event, and with it the ticket of a lossless cause, until the system has the bytes.
    // The table counts the size of the event, not that of its encoded form.
    const auto carriage = place.link->connection().send(
        form.packet(type, place.channel, send.share),
        [this, alive = std::weak_ptr(alive_), id = send.receiver, bytes = send.event->size()](bool written) {
            if (alive.expired() || !written)
                return;
            Decisions decisions;
            table_.written(id, bytes, lease_now(), decisions);
            execute(decisions);
        });
    place.shared += carriage == transport::Carriage::reference ? 1 : 0;
    place.fallback += carriage == transport::Carriage::fallback ? 1 : 0;
}

/// Sends the current state: an end that was revoked while it waited behind an event is sent as revoked. A receiver that
/// does not know `revoked` reads it as the end that it already has.
void Outlet::transmit_end(ReceiverId receiver)
{
    const Place& place = places_.at(receiver);
    protocol::End end = end_;
    end.revoked = !table_.told_end(receiver);
    end.answers = place.answered;
    end.add(hooks_.failures(table_.newest()));
    if (const auto missed = table_.missed(receiver); missed > 0)
        end.add(std::to_string(missed) + (missed == 1 ? " event" : " events") + " did not come to " + place.receiver
                + ", which was away for more than 30 s");
    send_end(place, end);
}

void Outlet::send_end(const Place& place, const protocol::End& end)
{
    place.link->connection().send(
        protocol::make_packet(PacketType::end, to_text(protocol::to_json(end)), place.channel));
}

void Outlet::say_leaving()
{
    for (const auto& [id, place] : places_)
        send_end(place, {.text = {}, .leaves = true});
}

void Outlet::refresh()
{
    const auto demand = table_.demand();
    const bool received = !places_.empty();
    const bool changed =
        demand.wanted != wanted_ || received != received_ || demand.asked != asked_ || demand.backlogged != backlogged_;
    wanted_ = demand.wanted;
    received_ = received;
    shares_ = std::ranges::any_of(
        places_, [](const auto& row) { return row.second.data && row.second.link->connection().shares(); });
    fans_out_ = demand.fans_out;
    asked_ = demand.asked;
    backlogged_ = demand.backlogged;
    if (changed)
        hooks_.changed();
}

OutputStatus Outlet::status() const
{
    return {.name = port_.name,
            .type = port_.type,
            .produced = produced_,
            .unreceived = table_.unreceived(),
            .last_emitted_us = last_emitted_us_,
            .lossless = lossless_,
            .edges = {},
            .why = table_.why()};
}

std::vector<EdgeStatus> Outlet::edges() const
{
    std::vector<EdgeStatus> edges;
    for (auto& row : table_.rows()) {
        if (const auto place = places_.find(row.id); place != places_.end()) {
            row.status.encoding = place->second.encoding.word();
            row.status.shared = place->second.shared;
            row.status.fallback = place->second.fallback;
        }
        edges.push_back(std::move(row.status));
    }
    return edges;
}

}  // namespace hive::event
