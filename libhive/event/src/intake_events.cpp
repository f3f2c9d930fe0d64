// Handles the packets of an intake, its reports to the sender, and its status.
#include <hive/event/emission.hpp>
#include <hive/event/module.hpp>
#include <hive/name.hpp>
#include <hive/printable.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

using protocol::PacketType;

namespace {

using namespace std::chrono_literals;

constexpr std::int64_t no_generation = -1;  // of an event that is not requested, and not acknowledged
constexpr auto late_report = 10ms;
constexpr std::size_t most_groups = 8;
constexpr std::size_t most_shown = 400;  // of an error in the status, which has a row per input

std::string text_of(const Error& error) { return error.what() + (error.advice().empty() ? "" : "; " + error.advice()); }

}  // namespace

void Intake::note_end(std::optional<std::string> text)
{
    if (end_ == text)
        return;
    end_ = std::move(text);
    changed();
}

void Intake::changed()
{
    on_end_();
    module_.look_at_ends();
}

void Intake::on_end(protocol::End end)
{
    if (end.disconnected)
        return dropped();
    sender_leaves_ = end.leaves;
    answered_ = std::max(answered_, end.answers);
    if (!end.leaves)
        note_end(end.revoked ? std::nullopt : std::optional(std::move(end.text)));
    module_.look_at_ends();
}

void Intake::ask_end(std::chrono::milliseconds within)
{
    ++question_;
    if (!connected_)
        return;
    auto request = progress_.told();
    request.end = question_;
    request.within_ms = std::min<std::int64_t>(within.count(), protocol::Request::most_within_ms);
    tell(request);
}

bool Intake::unsure() const
{
    return end_ && answered_ < question_ && !sender_leaves_ && !stopped() && !refusal() && !gone_for_good();
}

/// The sender ended the registration at an operator's request.
void Intake::dropped()
{
    const auto text = spec_.sender + "." + spec_.output + " was disconnected from " + spec_.receiver + " at its sender";
    release_link();
    disconnected();
    problem_ = Error(Errc::refused, text);
    note_end(text);
}

/// A sender may only send events of its own output.
void Intake::require_own(const Event& event) const
{
    const auto& peer = link_->peer();
    if (event.sender != peer.name || event.kind != peer.kind || event.output != spec_.output)
        throw Error(Errc::malformed, peer.name + " sent an event of " + in_quotes(event.sender + "." + event.output)
                                         + " (" + event.kind + ") on the channel of its " + spec_.output);
}

/// A large event may arrive after the confirmation of the connection that replaces this one. If it is lossless, neither
/// it nor what follows is acknowledged, so the sender sends it over the other connection when this one has left.
void Intake::on_packet(const protocol::Packet& packet)
{
    if (packet.type == PacketType::end)
        return on_end(protocol::end_from_json(parse_json(packet.header_text())));
    note_end(std::nullopt);
    Event event = event_from_packet(packet);
    require_own(event);
    if (packet.type == PacketType::notification || link_->credentials().role == Role::viewer)
        event.identity.lossless = false;  // the sender may skip it, so no result of it waits for a receiver
    if (!progress_.allows(event.identity.lossless))
        throw Error(Errc::malformed, spec_.sender + "." + spec_.output + " sent more events than it may");
    ++received_;
    const auto offset = event.identity.offset_us + link_->peer_clock().offset_us();
    event.identity.offset_us = std::clamp(offset, -max_json_integer, max_json_integer);  // both are a peer's word
    age_us_ = std::clamp<std::int64_t>(event.age().count(), -max_json_integer, max_json_integer);
    event.input = spec_.input;
    const bool refused = refuses_now();
    unacknowledged_ = unacknowledged_ || (refused && spec_.options.group.empty() && event.identity.lossless);
    event.ticket = unacknowledged_ ? ticket(no_generation, 0) : ticket(progress_.generation(), note_share(event));
    if (event.identity.lossless && progress_.has_late_news())
        flush();  // if this event ends the drone, the sender must not take an earlier one for the cause
    if (refused)
        conclude(event, Ending::discarded);
    else
        sink_(std::move(event));
}

void Intake::accept(Event event)
{
    ++received_;
    event.ticket = ticket(no_generation, 0);
    sink_(std::move(event));
}

Ticket Intake::ticket(std::int64_t generation, std::int64_t number)
{
    return {std::make_shared<Acknowledgement>(module_.weak_loop(), weak_from_this(), generation, number), true};
}

/// A halted member must not keep work from others, and a leaving input accepts nothing more.
bool Intake::refuses_now() const
{
    return stopped() || (!spec_.options.group.empty() && module_.paused() == Reason::halted);
}

/// @return  the number of the delivery
std::int64_t Intake::note_share(Event& event)
{
    auto& shares = event.identity.shares;
    const auto before = std::find_if_not(shares.rbegin(), shares.rend(),
                                         [&](const Share& share) { return share.sender() == spec_.sender; });
    if (before != shares.rend() && before->group())
        note_group(before->of);
    else
        sender_groups_.clear();  // no other drone does the work of this one
    const bool lossless = event.identity.lossless;
    if (shares.empty())
        return progress_.receive(lossless, 0);
    Share& share = shares.back();
    if (share.to.empty() && is_name(spec_.input))
        share.to = spec_.input;
    if (!group_ || share.of != group_->of || share.epoch != group_->epoch)
        return progress_.receive(lossless, 0);
    group_->turn = std::max(group_->turn, share.turn);
    group_->closed = std::max(group_->closed, share.closed);
    return progress_.receive(lossless, share.turn);
}

/// A worker that receives from several senders is a member of a group at each.
void Intake::note_group(const std::string& group)
{
    if (std::ranges::count(sender_groups_, group) > 0)
        return;
    sender_groups_.push_back(group);
    if (sender_groups_.size() > most_groups)
        sender_groups_.pop_front();
}

void Intake::heard(std::int64_t generation, std::int64_t number, bool worked, bool done, std::optional<Ending> ending)
{
    if (ending)
        ++ended_[static_cast<std::size_t>(*ending)];
    if (ending == Ending::abandoned || ending == Ending::dropped)
        last_lost_us_ = wall_us();
    const bool back = ending == Ending::discarded || ending == Ending::dropped;
    const bool worked_on = !all_worked();
    progress_.heard(generation, number, worked, done, back);
    flush();
    if (stopped()) {
        for (const auto& other : module_.intakes())
            if (worked && other->replaces(*this))
                other->flush();  // it has more room
        try_to_leave();
        end_if_done();
    }
    if (worked_on && all_worked() && (end_ || stopped()))
        changed();
}

void Intake::flush(bool late)
{
    if (!connected_)
        return;
    const bool may_ask = !stopped() && module_.paused() == Reason::none;
    tell(progress_.news(may_ask, late, may_ask ? held_before(module_.leaving(), true) : 0));
    if (late || !progress_.has_late_news() || std::exchange(report_due_, true))
        return;
    report_timer_.run_after(late_report, [weak = weak_from_this()] {
        if (const auto self = weak.lock()) {
            self->report_due_ = false;
            self->flush(true);
        }
    });
}

void Intake::tell(const std::optional<protocol::Request>& news)
{
    if (news)
        link_->connection().send(protocol::make_packet(PacketType::request, protocol::to_text(*news), channel_));
}

std::optional<Standing> Intake::standing() const
{
    if (!group_ || !connected_)
        return std::nullopt;
    return Standing{*group_, progress_.turns()};
}

InputStatus Intake::status() const
{
    const auto ended = [&](Ending ending) { return ended_[static_cast<std::size_t>(ending)]; };
    InputStatus status{.input = spec_.input,
                       .from = spec_.sender + "." + spec_.output,
                       .address = spec_.address.scheme == transport::Address::Scheme::tcp ? to_text(spec_.address) : "",
                       .kind = kind_,
                       .connected = connected_,
                       .registration = epoch_,
                       .options = spec_.options,
                       .received = received_,
                       .processed = ended(Ending::processed),
                       .abandoned = ended(Ending::abandoned),
                       .duplicates = ended(Ending::duplicate),
                       .discarded = ended(Ending::discarded),
                       .dropped = ended(Ending::dropped),
                       .unmatched = ended(Ending::unmatched),
                       .last_lost_us = last_lost_us_,
                       .last_age_us = age_us_,
                       .round_trip_us = link_ ? link_->peer_clock().round_trip_us() : 0,
                       .clock_offset_us = link_ ? link_->peer_clock().offset_us() : 0,
                       .disconnected_us = connected_ ? 0 : disconnected_us_,
                       .error = problem_ ? shortened(text_of(*problem_), most_shown) : ""};
    status.in_hand = received_;
    for (const auto count : ended_)
        status.in_hand -= count;
    if (connected_)
        status.why = module_.paused();
    if (refusal())
        status.why = Reason::refused;
    else if (end_ && status.why == Reason::none)
        status.why = Reason::source_ended;
    else if (!connected_)
        status.why = Reason::dialing;
    return status;
}

bool EndOfInputs::look(const Intakes& intakes, const Intakes& leaving)
{
    for (const auto& intake : intakes)
        intake->look_at_others(intakes);
    auto now = std::ranges::all_of(leaving, &Intake::all_worked) ? text_of(intakes) : std::nullopt;
    const std::lock_guard lock(mutex_);
    const bool changed = now != text_;
    text_ = std::move(now);
    if (changed) {
        ++number_;
        sure_ = whom_ == Of::drone;
    }
    return changed;
}

std::int64_t EndOfInputs::doubt()
{
    const std::lock_guard lock(mutex_);
    sure_ = whom_ == Of::drone;
    return ++number_;  // answers to earlier questions do not count for this one
}

bool EndOfInputs::confirm(std::int64_t end)
{
    const std::lock_guard lock(mutex_);
    sure_ = sure_ || end == number_;
    return sure_;
}

std::optional<std::string> EndOfInputs::text() const
{
    const std::lock_guard lock(mutex_);
    return sure_ ? text_ : std::nullopt;
}

std::optional<std::string> EndOfInputs::text_of(const Intakes& intakes) const
{
    bool any = false;
    protocol::End end;
    for (const auto& intake : intakes) {
        if (intake->spec().output == "exceptions")  // they never end
            continue;
        if ((!intake->ended() && !intake->gone_for_good()) || (whom_ == Of::drone && !intake->all_worked()))
            return std::nullopt;
        any = any || intake->ended();
        end.add(intake->ended().value_or(intake->lacks()));
    }
    return any ? std::optional(end.text) : std::nullopt;
}

}  // namespace hive::event
