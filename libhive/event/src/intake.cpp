// Registers at a sender, reconnects after a loss, and leaves.
#include <hive/event/module.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

using protocol::PacketType;

namespace {

using namespace std::chrono_literals;

constexpr auto dial_timeout = 3s;    // for one attempt to dial and register
constexpr int most_unreachable = 3;  // first attempts: a bad network may lose the packets of one, and not of the next
constexpr auto short_break = 10s;    // after a loss retries are frequent for this long: most networks are back by then
constexpr auto dial_timeout_in_break = 600ms;  // for one attempt to dial then, plus six round trips
constexpr auto pause_after_refusal = 1s;       // the sender is up, and would refuse again
constexpr auto leave_timeout = 30s;            // for work in progress at a stop
constexpr auto lost_for_good = 30s;            // a sender lost for longer does not delay the end
constexpr auto others_work = 2s;               // the same for a group's member, when another one is connected

/// A socket file belongs to the drone of its name; a port may belong to another drone by now.
std::optional<Error> wrong_peer(const IntakeSpec& spec, const Link& link)
{
    if (spec.address.scheme != transport::Address::Scheme::tcp || link.peer().name == spec.sender)
        return std::nullopt;
    return Error(Errc::unreachable,
                 "at " + to_text(spec.address) + " is " + link.peer().name + ", and not " + spec.sender);
}

Backoff backoff_for(const transport::Address& address)
{
    // Trying a missing local socket costs nothing, so a restarted drone is reached at once.
    const bool local = address.scheme != transport::Address::Scheme::tcp;
    return {local ? 5ms : 100ms, local ? 300ms : 4000ms, static_cast<std::uint32_t>(wall_us())};
}

}  // namespace

Intake::Intake(Module& module, IntakeSpec spec, Sink sink, std::function<void()> on_end)
    : module_(module),
      spec_(std::move(spec)),
      sink_(std::move(sink)),
      on_end_(std::move(on_end)),
      backoff_(backoff_for(spec_.address)),
      quick_backoff_(10ms, 200ms, static_cast<std::uint32_t>(wall_us())),
      timer_(module.context()),
      report_timer_(module.context())
{
}

void Intake::start(OnOutcome first, Clock::time_point until)
{
    first_ = std::move(first);
    first_until_ = until;
    unreachable_ = 0;
    attempt();
}

void Intake::await(OnOutcome another, Clock::time_point until)
{
    first_until_ = std::min(first_until_, until);  // no caller learns the outcome after its own deadline
    first_ = [first = std::move(first_), another = std::move(another)](const Outcome& outcome) {
        first(outcome);
        another(outcome);
    };
}

void Intake::answer(const Outcome& outcome)
{
    if (const auto first = std::exchange(first_, {}))
        first(outcome);
}

void Intake::change(const ConnectionOptions& options, OnOutcome first, Clock::time_point until)
{
    before_ = std::exchange(spec_.options, options);
    disconnected();
    release_link();  // events in transit there are sent again
    start(std::move(first), until);
}

/// TCP retransmits packets that were sent without network only after one second, and then after two more; a new dial is
/// faster.
bool Intake::in_short_break() const
{
    return lost_ && spec_.address.scheme == transport::Address::Scheme::tcp && Clock::now() < *lost_ + short_break;
}

/// An intake whose first attempt is unanswered is not delayed, since connects register in the order of their requests.
bool Intake::holds()
{
    held_up_ = held_ > 0 && !first_;
    return held_up_;
}

void Intake::let_go_on()
{
    if (--held_ == 0 && std::exchange(held_up_, false) && !stopped())
        attempt();
}

void Intake::attempt()
{
    if (holds())
        return;
    const std::chrono::microseconds round_trips(6 * round_trip_us_);
    const Clock::time_point deadline =
        Clock::now() + (in_short_break() ? dial_timeout_in_break + round_trips : dial_timeout);
    module_.with_link(spec_.address, deadline, [self = shared_from_this(), deadline](const Result<LinkPtr>& found) {
        if (self->stopped() || self->holds())
            return;
        const auto link = value_or_none(found);
        if (!link)
            self->failed(*error_of(found));
        else if (const auto wrong = wrong_peer(self->spec_, *link))
            self->failed(*wrong);
        else
            self->register_on(link, self->lost_ ? Clock::now() + dial_timeout : deadline);
    });
}

void Intake::register_on(const LinkPtr& link, Clock::time_point deadline)
{
    link_ = link;
    epoch_ = module_.next_registration();
    if (link->peer().epoch != sender_epoch_)
        progress_.lose_place();
    sender_epoch_ = link->peer().epoch;
    const bool may_ask = module_.paused() == Reason::none;
    protocol::Registration registration{.id = 0,
                                        .epoch = epoch_,
                                        .output = spec_.output,
                                        .receiver = spec_.receiver,
                                        .accepts = spec_.accepts,
                                        .stateful = spec_.stateful,
                                        .options = spec_.options,
                                        .place = progress_.place(),
                                        .taken = {},
                                        .held = progress_.held(may_ask) + held_before(module_.intakes(), may_ask)
                                                + held_before(module_.leaving(), may_ask),
                                        .tried = tried_};
    tried_ = tried_ != 0 ? tried_ : epoch_;
    if (progress_.place() != 0)
        registration.taken = progress_.arrived();
    try {
        channel_ = link->claim_channel([weak = weak_from_this()](const protocol::Packet& packet) {
            if (const auto intake = weak.lock())
                intake->on_packet(packet);
        });
    } catch (const Error& error) {
        link_.reset();
        return failed(error);
    }
    // Owned by the link, so it must own neither the link nor this, which owns the link.
    const auto on_outcome = [weak = weak_from_this(), to = std::weak_ptr(link),
                             held = registration.held](const Outcome& outcome) {
        const auto self = weak.lock();
        const auto there = to.lock();
        if (!self || self->stopped() || !there || there != self->link_)
            return;
        if (const auto* error = std::get_if<Error>(&outcome)) {
            self->release_link();
            return self->failed(*error);
        }
        self->confirmed(there, std::get<Json>(outcome), held);
    };
    link->request(PacketType::register_receiver, to_json(registration), {}, deadline, on_outcome, channel_);
    module_.arm();
}

/// The collectors of an application are independent of each other.
bool Intake::replaces(const Intake& other) const
{
    return &other != this && other.spec_.sender == spec_.sender && other.spec_.output == spec_.output
           && other.spec_.receiver == spec_.receiver && spec_.receiver != module_.self().name;
}

/// What earlier connections of these ends still have in hand takes room, too.
std::int64_t Intake::held_before(const std::vector<std::shared_ptr<Intake>>& intakes, bool may_ask) const
{
    std::int64_t sum = 0;
    for (const auto& other : intakes)
        if (replaces(*other))
            sum += other->progress_.held(may_ask);
    return sum;
}

void Intake::confirmed(const LinkPtr& link, const Json& result, std::int64_t held)
{
    try {
        const Fields fields(result, "confirmation of register");
        if (!progress_.begin(epoch_, spec_.options, fields.integer_or("place", 0, max_json_integer, 0),
                             fields.integer_or("taken", 0, max_json_integer, 0), held))
            group_.reset();
        if (!spec_.options.group.empty() && !group_)
            group_ = Share{.of = spec_.sender + "." + spec_.output + "#" + spec_.options.group,
                           .epoch = sender_epoch_,
                           .turn = fields.integer_or("turn", 0, max_json_integer, 0),
                           .closed = fields.integer_or("closed", 0, max_json_integer, 0)};
    } catch (const Error& error) {
        release_link();  // no pending call would report its end any more
        link->close(error);
        return failed(error);
    }
    connected_ = true;
    kind_ = link->peer().file.empty() ? link->peer().kind : link->peer().file;
    tried_ = 0;
    sender_leaves_ = replaced_ = false;
    end_.reset();  // the sender sends its end again, if it still holds, and is then asked again
    answered_ = question_;
    changed();
    before_.reset();
    problem_.reset();
    backoff_.reset();
    quick_backoff_.reset();
    lost_.reset();
    answer(result);
    flush();
    keep_time();
}

/// The ages of events need the clock of a remote sender as long as it sends.
void Intake::keep_time()
{
    if (!connected_ || stopped() || link_->local())
        return;
    link_->ask_time();
    module_.arm();
    timer_.run_at(std::max(link_->peer_clock().due(), Clock::now() + 10ms), [weak = weak_from_this()] {
        if (const auto self = weak.lock())
            self->keep_time();
    });
}

void Intake::failed(const Error& error)
{
    problem_ = error;
    // A sender that says nothing may be busy: only the deadline decides.
    if (error.code() == Errc::unreachable)
        ++unreachable_;
    if (refusal() || unreachable_ == most_unreachable || Clock::now() + dial_timeout >= first_until_) {
        if (before_)
            spec_.options = *std::exchange(before_, std::nullopt);
        answer(error);
    }
    if (!stopped())
        retry();
    changed();
}

void Intake::retry()
{
    const auto pause = in_short_break() ? quick_backoff_.next() : backoff_.next();
    timer_.run_after(refusal() ? std::max<Clock::duration>(pause, pause_after_refusal) : pause,
                     [weak = weak_from_this()] {
                         if (const auto self = weak.lock(); self && !self->stopped())
                             self->attempt();
                     });
}

void Intake::stop(std::function<void()> left)
{
    stage_ = std::max(stage_, Stage::draining);
    timer_.cancel();
    on_left_ = std::move(left);
    answer(Error(Errc::stopped, spec_.receiver + ": this connection was replaced or ended before it was made"));
    module_.look_at_ends();  // it will not answer any more
    if (connected_ && !progress_.empty()) {
        timer_.run_after(leave_timeout, [weak = weak_from_this()] {
            if (const auto self = weak.lock())
                self->leave_now();
        });
    }
    try_to_leave();
}

void Intake::hand_over()
{
    stage_ = std::max(stage_, Stage::leaving);
    timer_.cancel();
    answer(Error(Errc::stopped, spec_.receiver + ": another process takes over before this connection was made"));
    forget_unfinished();
    connected_ = false;
    release_link();  // what arrives from now on is sent again, to the other process
    end_if_done();
}

void Intake::leave_now()
{
    acknowledge_held();
    forget_unfinished();
    try_to_leave();
}

/// The sender must not give up as unprocessed what has a result already.
void Intake::forget_unfinished()
{
    if (connected_)
        tell(progress_.last_news());
    progress_.forget();
}

/// Results that wait for their first receiver are kept, so their events can be acknowledged without loss.
void Intake::acknowledge_held()
{
    if (connected_ && all_worked() && !progress_.empty() && module_.holds())
        tell(progress_.acknowledge_all());
}

/// Finishes lossless and shared work first, but does not wait for other events. A group continues without this member's
/// answer, but an ordered collector would not wait for the answer of an acknowledged event.
void Intake::try_to_leave()
{
    const bool shared = !spec_.options.group.empty();
    if (!shared)
        acknowledge_held();
    const bool owed = shared ? !progress_.empty() : progress_.lossless_in_hand();
    if (stage_ >= Stage::leaving || (connected_ && owed))
        return;
    if (connected_)
        tell(progress_.last_news());
    stage_ = Stage::leaving;
    timer_.cancel();
    const auto left = [self = shared_from_this()] {
        self->connected_ = false;
        self->stage_ = Stage::left;
        std::exchange(self->on_left_, [] {})();
        self->end_if_done();
    };
    const auto link = release_link();
    connected_ = false;
    if (!link || !link->open())
        return left();
    link->request(
        PacketType::deregister, Json::object(), {}, Clock::now() + dial_timeout, [left](const Outcome&) { left(); },
        channel_);
    module_.arm();
}

void Intake::end_if_done()
{
    std::int64_t ended = 0;
    for (const auto count : ended_)
        ended += count;
    if (stage_ >= Stage::leaving && ended == received_)
        module_.gone(shared_from_this());
}

/// Later packets on its channel are dropped.
LinkPtr Intake::release_link()
{
    if (link_)
        link_->release_channel(channel_);
    return std::exchange(link_, nullptr);
}

void Intake::link_closed(const Link& link)
{
    if (link_.get() != &link)
        return;
    link_.reset();
    if (!connected_)
        return;  // the pending registration reports it
    disconnected();
    problem_ = Error(Errc::connection_lost, "connection lost");
    lost_ = Clock::now();
    round_trip_us_ = link.peer_clock().round_trip_us();
    if (stopped())
        return try_to_leave();
    retry();
    changed();
}

void Intake::disconnected()
{
    connected_ = false;
    disconnected_us_ = wall_us();
    lost_at_ = Clock::now();
}

/// Any error except an unreachable or silent sender.
std::optional<Error> Intake::refusal() const
{
    if (connected_ || !problem_)
        return std::nullopt;
    switch (problem_->code()) {
    case Errc::unreachable:
    case Errc::connection_lost:
    case Errc::timeout:
    case Errc::stopped:
    case Errc::io: return std::nullopt;
    default: return problem_;
    }
}

bool Intake::gone_for_good() const
{
    return !connected_ && (sender_leaves_ || replaced_ || Clock::now() - lost_at_ >= lost_for_good);
}

void Intake::look_at_others(const std::vector<std::shared_ptr<Intake>>& all)
{
    const auto has_another = [&](const std::string& group) {
        return std::ranges::any_of(all, [&](const auto& other) {
            return other->connected_ && other->spec_.sender != spec_.sender && other->spec_.output != "exceptions"
                   && std::ranges::count(other->sender_groups_, group) > 0;
        });
    };
    replaced_ = replaced_
                || (!connected_ && Clock::now() - lost_at_ >= others_work && !sender_groups_.empty()
                    && std::ranges::all_of(sender_groups_, has_another));
}

std::string Intake::lacks() const
{
    return sender_leaves_ || replaced_ ? "" : spec_.sender + " was lost, and has not come back within 30 s";
}

}  // namespace hive::event
