// Registering, credit and acknowledgement at the receiving end.
#include <hive/event/clock.hpp>
#include <hive/event/door.hpp>
#include <hive/event/emission.hpp>
#include <hive/event/intake.hpp>
#include <hive/name.hpp>
#include <hive/printable.hpp>

#include <algorithm>

namespace hive::event {

using protocol::PacketType;

namespace {

using namespace std::chrono_literals;

constexpr auto patience = 3s;      // for one attempt to dial and register
constexpr auto short_break = 10s;  // so long after a loss it is tried more often: most networks are back by then
constexpr auto patience_in_break = 600ms;   // for one attempt to dial then, and six round trips more
constexpr auto patience_to_leave = 30s;     // for what is in hand when it is told to stop
constexpr std::size_t most_shown = 400;     // of an error in the status, which has a row for each input
constexpr std::int64_t told_at_least = 16;  // a stream tells what it has dealt with after so many events
constexpr auto lost_for_good = 2s;          // who has not come back by then does not hold up the end of the others

/// A socket file is the name of its drone; a port may be another one's by now.
std::optional<Error> met_another(const IntakeSpec& spec, const Link& link)
{
    if (spec.address.scheme != transport::Address::Scheme::tcp || link.peer().name == spec.sender)
        return std::nullopt;
    return Error(Errc::unreachable,
                 "at " + to_text(spec.address) + " is " + link.peer().name + ", and not " + spec.sender);
}

Backoff backoff_for(const transport::Address& address)
{
    // A local socket that is not there costs nothing to try, so a restarted drone is met again at once.
    const bool local = address.scheme != transport::Address::Scheme::tcp;
    return {local ? 50ms : 100ms, local ? 300ms : 4000ms, static_cast<std::uint32_t>(wall_us())};
}

}  // namespace

Intake::Intake(IntakeHost& host, IntakeSpec spec, Sink sink, std::function<void()> on_end)
    : host_(host),
      spec_(std::move(spec)),
      sink_(std::move(sink)),
      on_end_(std::move(on_end)),
      backoff_(backoff_for(spec_.address)),
      quick_backoff_(100ms, 200ms, static_cast<std::uint32_t>(wall_us())),
      timer_(host.context())
{
}

void Intake::start(OnOutcome first)
{
    first_ = std::move(first);
    attempt();
}

void Intake::change(const ConnectionOptions& options, OnOutcome on_outcome)
{
    before_ = std::exchange(spec_.options, options);
    first_ = std::move(on_outcome);
    disconnected();
    link_->release_channel(channel_);  // what is under way there comes again
    register_on(link_, Clock::now() + patience);
}

/// What the kernel sent while there was no network it sends again only after one second, and then after two more.
bool Intake::in_short_break() const
{
    return lost_ && spec_.address.scheme == transport::Address::Scheme::tcp && Clock::now() < *lost_ + short_break;
}

void Intake::attempt()
{
    const std::chrono::microseconds round_trips(6 * round_trip_us_);
    const Clock::time_point deadline = Clock::now() + (in_short_break() ? patience_in_break + round_trips : patience);
    host_.with_link(spec_.address, deadline,
                    [self = shared_from_this(), deadline](const LinkPtr& link, const Error& error) {
                        if (self->stopped_)
                            return;
                        if (!link)
                            self->failed(error);
                        else if (const auto wrong = met_another(self->spec_, *link))
                            self->failed(*wrong);
                        else
                            self->register_on(link, self->lost_ ? Clock::now() + patience : deadline);
                    });
}

void Intake::register_on(const LinkPtr& link, Clock::time_point deadline)
{
    link_ = link;
    epoch_ = std::max(epoch_ + 1, wall_us());
    if (link->peer().epoch != sender_epoch_)
        place_ = 0;  // it was started again, and knows nothing of the place
    sender_epoch_ = link->peer().epoch;
    protocol::Registration registration{.id = 0,
                                        .epoch = epoch_,
                                        .output = spec_.output,
                                        .receiver = spec_.receiver,
                                        .accepts = spec_.accepts,
                                        .stateful = spec_.stateful,
                                        .options = spec_.options,
                                        .place = place_,
                                        .taken = {}};
    if (place_ != 0)
        registration.taken = arrived();
    channel_ = link->claim_channel([weak = weak_from_this()](const protocol::Packet& packet) {
        if (const auto intake = weak.lock())
            intake->on_packet(packet);
    });
    const auto on_outcome = [self = shared_from_this(), link](const Outcome& outcome) {
        if (self->stopped_ || link != self->link_)
            return;
        if (const auto* error = std::get_if<Error>(&outcome)) {
            link->release_channel(self->channel_);
            self->link_.reset();
            return self->failed(*error);
        }
        self->confirmed(link, std::get<Json>(outcome));
    };
    link->request(PacketType::register_receiver, to_json(registration), {}, deadline, on_outcome, channel_);
    host_.arm();
}

void Intake::confirmed(const LinkPtr& link, const Json& result)
{
    try {
        const Fields fields(result, "confirmation of register");
        begin_numbering(fields.integer_or("place", 0, max_json_integer, 0),
                        fields.integer_or("taken", 0, max_json_integer, 0));
        if (!spec_.options.group.empty() && !group_)
            group_ = Share{.of = spec_.sender + "." + spec_.output + "#" + spec_.options.group,
                           .epoch = sender_epoch_,
                           .turn = fields.integer_or("turn", 0, max_json_integer, 0),
                           .closed = fields.integer_or("closed", 0, max_json_integer, 0)};
    } catch (const Error& error) {
        return link->close(error);
    }
    connected_ = true;
    end_.reset();  // the sender tells of it again, if it is still so
    on_end_();
    before_.reset();
    problem_.reset();
    backoff_.reset();
    quick_backoff_.reset();
    lost_.reset();
    if (const auto first = std::exchange(first_, {}))
        first(result);
    flush();
    keep_time();
}

/// The ages of events need the clock of a sender on another machine, for as long as it sends.
void Intake::keep_time()
{
    if (!connected_ || stopped_ || link_->local())
        return;
    link_->ask_time();
    host_.arm();
    timer_.expires_at(std::max(link_->peer_clock().due(), Clock::now() + 10ms));
    timer_.async_wait([weak = weak_from_this()](std::error_code problem) {
        if (const auto self = weak.lock(); self && !problem)
            self->keep_time();
    });
}

/// What this end has in hand stays in hand only where the sender goes on behind it.
void Intake::begin_numbering(std::int64_t place, std::int64_t taken)
{
    if (place == 0 || place != place_ || taken != arrived()) {
        ++generation_;
        in_hand_.clear();
        done_ = worked_ = finished_ = taken;
        group_.reset();
    }
    place_ = place;
    back_.clear();
    asked_ = arrived() + spec_.options.window;
    told_done_ = told_worked_ = taken == done_ ? done_ : 0;  // what was told at an end may not have come through
    finished_ = std::max(finished_, done_);
}

void Intake::failed(const Error& error)
{
    problem_ = error;
    if (before_)
        spec_.options = *std::exchange(before_, std::nullopt);
    if (const auto first = std::exchange(first_, {}))
        first(error);
    if (!stopped_)
        retry();
    on_end_();
}

void Intake::retry()
{
    timer_.expires_after(in_short_break() ? quick_backoff_.next() : backoff_.next());
    timer_.async_wait([weak = weak_from_this()](std::error_code problem) {
        if (const auto self = weak.lock(); self && !problem && !self->stopped_)
            self->attempt();
    });
}

void Intake::stop(std::function<void()> left)
{
    stopped_ = true;
    timer_.cancel();
    on_left_ = std::move(left);
    if (const auto first = std::exchange(first_, {}))
        first(Error(Errc::stopped, spec_.receiver + ": this connection was replaced or ended before it was made"));
    if (connected_ && !in_hand_.empty()) {
        timer_.expires_after(patience_to_leave);
        timer_.async_wait([weak = weak_from_this()](std::error_code problem) {
            if (const auto self = weak.lock(); self && !problem)
                self->leave_now();
        });
    }
    try_to_leave();
}

void Intake::leave_now()
{
    ++generation_;
    in_hand_.clear();
    try_to_leave();
}

/// Work that somebody else would do again is ended first; what is merely being looked at is not waited for.
void Intake::try_to_leave()
{
    const bool owed = !spec_.options.group.empty()
                      || std::ranges::any_of(in_hand_, [](const Delivery& each) { return each.lossless; });
    if (left_ || (connected_ && owed && !in_hand_.empty()))
        return;
    left_ = true;
    timer_.cancel();
    const auto tell = [self = shared_from_this()] {
        self->connected_ = false;
        std::exchange(self->on_left_, [] {})();
        self->end_if_done();
    };
    const auto link = std::exchange(link_, nullptr);
    connected_ = false;
    if (!link || !link->open())
        return tell();
    link->release_channel(channel_);
    link->request(
        PacketType::deregister, Json::object(), {}, Clock::now() + patience, [tell](const Outcome&) { tell(); },
        channel_);
    host_.arm();
}

void Intake::end_if_done()
{
    std::int64_t ended = 0;
    for (const auto count : ended_)
        ended += count;
    if (left_ && ended == received_)
        host_.gone(shared_from_this());
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
    if (stopped_)
        try_to_leave();
    else
        retry();
}

void Intake::disconnected()
{
    connected_ = false;
    lost_at_ = Clock::now();
}

bool Intake::given_up() const { return !connected_ && Clock::now() - lost_at_ >= lost_for_good; }

void Intake::note_end(std::optional<std::string> text)
{
    if (end_ == text)
        return;
    end_ = std::move(text);
    on_end_();
}

void Intake::on_packet(const protocol::Packet& packet)
{
    if (packet.type == PacketType::end)
        return note_end(protocol::end_from_json(parse_json(packet.header_text())).text);
    note_end(std::nullopt);
    if (spec_.options.transfer == Transfer::synchronized && arrived() >= asked_)
        throw Error(Errc::malformed, spec_.sender + "." + spec_.output + " sent more events than it was asked for");
    Event event = event_from_packet(packet);
    if (packet.type == PacketType::notification)
        event.identity.lossless = false;  // it may be skipped, so what comes of it is held for nobody
    ++received_;
    event.identity.offset_us += link_ ? link_->peer_clock().offset_us() : 0;
    age_us_ = event.age().count();
    event.input = spec_.input;
    note_share(event);
    give_receipt(event, {host_.door(), weak_from_this(), generation_, arrived()});
    if (refuses_now())
        conclude(event, Ending::discarded);
    else
        sink_(std::move(event));
}

void Intake::accept(Event event)
{
    ++received_;
    constexpr std::int64_t no_generation = -1;  // there is nobody to ask or to acknowledge
    give_receipt(event, {host_.door(), weak_from_this(), no_generation, 0});
    sink_(std::move(event));
}

/// A halted member keeps no work from others, and an input that leaves takes nothing more.
bool Intake::refuses_now() const
{
    return stopped_ || (!spec_.options.group.empty() && host_.paused() == Reason::halted);
}

void Intake::note_share(Event& event)
{
    Delivery& delivery = in_hand_.emplace_back();
    delivery.lossless = lossless_ = event.identity.lossless;
    if (event.identity.shares.empty())
        return;
    Share& share = event.identity.shares.back();
    if (group_ && share.of == group_->of && share.epoch == group_->epoch) {
        delivery.turn = share.turn;
        group_->turn = std::max(group_->turn, share.turn);
        group_->closed = std::max(group_->closed, share.closed);
    }
    if (share.to.empty() && is_name(spec_.input))
        share.to = spec_.input;
}

Intake::Delivery* Intake::delivery(std::int64_t number)
{
    const auto index = number - done_ - 1;
    return index < 0 || index >= static_cast<std::int64_t>(in_hand_.size())
               ? nullptr
               : &in_hand_[static_cast<std::size_t>(index)];
}

void Intake::heard(std::int64_t generation, std::int64_t number, bool worked, bool done, std::optional<Ending> ending)
{
    if (ending)
        ++ended_[static_cast<std::size_t>(*ending)];
    Delivery* one = generation == generation_ ? delivery(number) : nullptr;
    if (one) {
        finished_ += worked && !one->worked ? 1 : 0;
        one->worked = one->worked || worked;
        one->done = one->done || done;
        const bool begun = !ending || (*ending != Ending::discarded && *ending != Ending::dropped);
        if (!begun && !spec_.options.group.empty())
            back_.push_back(number);
        for (; !in_hand_.empty() && in_hand_.front().done && in_hand_.front().worked; in_hand_.pop_front())
            ++done_;
        const auto not_worked = std::ranges::find(in_hand_, false, &Delivery::worked);
        worked_ = done_ + (not_worked - in_hand_.begin());
    }
    flush();
    if (stopped_) {
        try_to_leave();
        end_if_done();
    } else if (end_ && all_worked()) {
        on_end_();
    }
}

/// Is there something to tell that cannot go with a later request?
bool Intake::ask_now(std::int64_t ask, std::int64_t worked) const
{
    if (!back_.empty())
        return true;
    const bool waits = worked_ < arrived();  // something is being worked on, and its end will be told
    if (spec_.options.transfer == Transfer::streaming)
        return (done_ > told_done_ || worked > told_worked_)
               && (!waits || lossless_ || worked - told_worked_ >= told_at_least);
    return ask > asked_ || (worked > told_worked_ && !spec_.options.group.empty()) || (done_ > told_done_ && !waits);
}

void Intake::flush()
{
    if (!connected_)
        return;
    const bool may_ask = !stopped_ && host_.paused() == Reason::none;
    const bool streaming = spec_.options.transfer == Transfer::streaming;
    const auto ask = may_ask ? std::max(asked_, spec_.options.window + finished_) : asked_;
    // A stream asks for nothing: what it has worked on lets more lossless events come.
    const auto worked = may_ask || !streaming ? worked_ : std::max(told_worked_, done_);
    if (!ask_now(ask, worked))
        return;
    asked_ = ask;
    told_done_ = done_;
    told_worked_ = worked;
    link_->connection().send(protocol::make_packet(
        PacketType::request, protocol::to_text({epoch_, ask, done_, worked, std::exchange(back_, {})}), channel_));
}

std::optional<Standing> Intake::standing() const
{
    if (!group_ || !connected_)
        return std::nullopt;
    Standing standing{*group_, {}};
    for (const auto& each : in_hand_)
        if (each.turn != 0 && !each.done)
            standing.open.push_back(each.turn);
    return standing;
}

InputStatus Intake::status() const
{
    const auto ended = [&](Ending ending) { return ended_[static_cast<std::size_t>(ending)]; };
    InputStatus status{.input = spec_.input,
                       .from = spec_.sender + "." + spec_.output,
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
                       .last_age_us = age_us_,
                       .round_trip_us = link_ ? link_->peer_clock().round_trip_us() : 0,
                       .clock_offset_us = link_ ? link_->peer_clock().offset_us() : 0,
                       .error = problem_ ? shortened(problem_->what(), most_shown) : ""};
    status.in_hand = received_;
    for (const auto count : ended_)
        status.in_hand -= count;
    if (connected_)
        status.why = host_.paused();
    if (end_ && status.why == Reason::none)
        status.why = Reason::source_ended;
    else if (!connected_)
        status.why = problem_ && problem_->code() == Errc::refused ? Reason::refused : Reason::dialing;
    return status;
}

namespace {

/// Each text once, joined.
void add_text(std::string& all, const std::string& text)
{
    if (!text.empty() && ("; " + all + "; ").find("; " + text + "; ") == std::string::npos)
        all += (all.empty() ? "" : "; ") + text;
}

}  // namespace

std::optional<std::string> end_of(const std::vector<std::shared_ptr<Intake>>& intakes, bool worked)
{
    constexpr auto exceptions = "exceptions";  // they never end
    bool any = false;
    std::string text;
    for (const auto& intake : intakes) {
        if (intake->spec().output == exceptions)
            continue;
        if ((!intake->ended() && !intake->given_up()) || (worked && !intake->all_worked()))
            return std::nullopt;
        any = any || intake->ended();
        add_text(text, intake->ended().value_or(""));
    }
    return any ? std::optional(text) : std::nullopt;
}

}  // namespace hive::event
