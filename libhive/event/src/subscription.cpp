// Decides which consumer gets which event, and tracks its outcome.
#include <hive/event/subscription.hpp>
#include <hive/protocol/defended.hpp>

#include <algorithm>
#include <tuple>
#include <utility>

namespace hive::event {

bool Subscription::Consumer::has(std::int64_t job) const
{
    return job != 0 && std::ranges::find(hands, job, &Handed::job) != hands.end();
}

bool Subscription::retiring() const noexcept
{
    return std::ranges::any_of(consumers_, [](const auto& row) { return row.second.retired; });
}

bool Subscription::comes_back(const Job& job) const { return job.event && (shared() || must_arrive(job.event)); }

bool Subscription::streams() const { return !shared() && present() && consumers_.begin()->second.credit.streaming(); }

/// Calls it with each lossless event here.
void Subscription::for_lossless(const std::function<void(const EmissionPtr&)>& call) const
{
    const auto look = [&](const EmissionPtr& event) {
        if (event && must_arrive(event))
            call(event);
    };
    for (const auto& [number, job] : open_)
        look(job.event);
    std::ranges::for_each(fresh_, look);
}

bool Subscription::must_something_arrive() const
{
    bool any = false;
    for_lossless([&](const EmissionPtr&) { any = true; });
    return any;
}

/// Before the first event it is unknown whether the source waits for its consumers.
bool Subscription::worth_keeping() const
{
    return !kind_.passive && (lossless_.value_or(true) || must_something_arrive());
}

// --- events that wait ---

void Subscription::wait(const EmissionPtr& event)
{
    fresh_bytes_ += event->size();
    fresh_.push_back(event);
}

EmissionPtr Subscription::take_fresh()
{
    EmissionPtr event = std::move(fresh_.front());
    fresh_.pop_front();
    fresh_bytes_ -= event->size();
    return event;
}

void Subscription::offer(const EmissionPtr& event, Clock::time_point now, Decisions& decisions)
{
    const Identity& identity = event->event().identity;
    if (missed_.count > 0 && identity.epoch > missed_.epoch && identity.source == missed_.source)
        missed_.count = 0;
    lossless_ = must_arrive(event);
    if (!present() && !(awaited_ && *lossless_)) {
        if (awaited_ && !worth_keeping())
            stop_waiting();
        miss(identity, now);
        return;  // it would be outdated when a consumer attaches
    }
    ledger_.came();
    go_on(decisions);
    if (!streams() && !*lossless_)
        skip_newest_live();
    if (waiting() == 0)
        behind_since_ = now;
    wait(event);
    do
        pump(now, decisions);
    while (streams() && drop_oldest(now));  // an event that was too large for the lane delayed smaller ones
}

void Subscription::count(Fate fate, std::int64_t events)
{
    ledger_.went(fate, events);
    if (events > 0 && is_loss(fate))
        last_lost_us_ = wall_us();
}

void Subscription::miss(const Identity& identity, Clock::time_point now)
{
    if (!missing_as_ || (!*lossless_ && now >= live_missed_until_))
        return;
    ledger_.came();
    count(*missing_as_);
    if (*lossless_)
        count_missed(identity);
}

void Subscription::count_missed(const Identity& identity)
{
    missed_ = {.count = missed_.count + 1, .source = identity.source, .epoch = identity.epoch};
    missed_more_ = true;
}

void Subscription::skip_newest_live()
{
    if (fresh_.empty() || must_arrive(fresh_.back()))
        return;
    fresh_bytes_ -= fresh_.back()->size();
    fresh_.pop_back();
    ledger_.went(Fate::skipped);
}

void Subscription::end_live(Fate how)
{
    const auto live = std::erase_if(fresh_, [this](const EmissionPtr& event) {
        const bool goes = !must_arrive(event);
        fresh_bytes_ -= goes ? event->size() : 0;
        return goes;
    });
    count(how, static_cast<std::int64_t>(live));
}

bool Subscription::overfull(Clock::time_point now) const
{
    static const bool judged = defended("most-behind");
    const bool too_slow = judged && now - behind_since_ >= max_behind;
    return fresh_.size() > max_queued_events || (fresh_.size() > 1 && fresh_bytes_ > max_queued_bytes)
           || (too_slow && fresh_.size() > 2 && fresh_bytes_ > Credit::lane_bytes);
}

bool Subscription::drop_oldest(Clock::time_point now)
{
    bool dropped = false;
    while (overfull(now)) {
        const auto oldest =
            std::ranges::find_if(fresh_, [this](const EmissionPtr& event) { return !must_arrive(event); });
        if (oldest == fresh_.end())
            break;
        fresh_bytes_ -= (*oldest)->size();
        fresh_.erase(oldest);
        count(Fate::dropped);
        dropped = true;
    }
    return dropped;
}

// --- jobs ---

/// Chooses the consumer with the fewest events in progress, then the one that asked first, among those with credit that
/// do not have the job. A consumer with a full connection comes last.
Subscription::Consumers::iterator Subscription::choose(std::int64_t job, const EmissionPtr& event)
{
    auto best = consumers_.end();
    const auto rank = [&](const Consumer& one) {
        return std::tuple(!one.credit.lane_free(event->size()), one.hands.size(), one.asked_at);
    };
    for (auto it = consumers_.begin(); it != consumers_.end(); ++it) {
        const Consumer& one = it->second;
        if (one.retired || one.suspect || !one.credit.open(shared() || must_arrive(event)) || one.has(job))
            continue;
        if (best == consumers_.end() || rank(one) < rank(best->second))
            best = it;
    }
    return best;
}

/// A job that every consumer with credit already has must wait for another consumer, or for its answer.
void Subscription::pump(Clock::time_point now, Decisions& decisions)
{
    for (auto next = again_.begin(); next != again_.end();) {
        const auto number = *next;
        const EmissionPtr& event = open_.at(number).event;
        const auto to = choose(number, event);
        if (to == consumers_.end()) {
            ++next;
            continue;
        }
        if (!to->second.credit.lane_free(event->size()))
            return;
        next = again_.erase(next);
        give(to, number, now, decisions);
    }
    while (!fresh_.empty()) {
        const auto to = choose(0, fresh_.front());
        if (to == consumers_.end() || !to->second.credit.lane_free(fresh_.front()->size()))
            return;
        open_[++jobs_].event = take_fresh();
        give(to, jobs_, now, decisions);
    }
    tell_end(decisions);
}

void Subscription::give(Consumers::iterator to, std::int64_t number, Clock::time_point now, Decisions& decisions)
{
    auto& [id, consumer] = *to;
    Job& job = open_.at(number);
    job.attempt = std::min(job.attempt + 1, max_attempt);
    ++job.holders;
    if (!consumer.works())
        consumer.head_since = now;
    consumer.credit.sent(job.event->size());
    const bool shows = may_show(consumer, job.event);
    consumer.hands.push_back({.job = number, .live = shows ? job.event : nullptr});
    if (consumer.own)
        consumer.own->ledger.came();
    decisions.sends.push_back({id, job.event, consumer.options.delivery, told(number, job)});
    if (!comes_back(job))
        job.event = nullptr;
}

/// A lossless event is kept as a job anyway; a copy here would delay the acknowledgement of its cause. The bound
/// assumes events of one size; the events of a receiver with a window are in its memory as well.
bool Subscription::may_show(const Consumer& consumer, const EmissionPtr& event) const
{
    const auto before = consumer.hands.size();
    return !event->lossless() && !kind_.passive && !kind_.application && consumer.options.delivery == Delivery::data
           && (before == 0 || (before < max_shown_events && (before + 1) * event->size() <= max_shown_bytes));
}

/// Reports the first unprocessed event, after the unacknowledged ones that are still here. A streaming consumer reports
/// its progress only every few events, so it may have got further.
void Subscription::show_hands(ReceiverId id, const Consumer& consumer, Decisions& decisions) const
{
    const std::size_t untold = consumer.options.transfer == Transfer::streaming ? 15 : 0;
    for (std::size_t i = 0; i < consumer.hands.size() && i <= consumer.head() + untold; ++i) {
        const Handed& handed = consumer.hands[i];
        const auto job = open_.find(handed.job);
        if (const auto& event = handed.live || job == open_.end() ? handed.live : job->second.event)
            decisions.failed_at.push_back({.receiver = id, .event = event, .worked = i < consumer.head()});
    }
}

Share Subscription::share(std::int64_t number, const Job& job) const
{
    Share share = standing();
    share.turn = number;
    share.attempt = job.attempt;
    share.part = job.event->event().identity.part;
    return share;
}

/// Not shared: all receivers of the output get the same share at first.
std::optional<Share> Subscription::told(std::int64_t number, const Job& job) const
{
    if (job.adopted_as) {
        Share share = *job.adopted_as;
        share.attempt = job.attempt;
        return share;
    }
    if (shared())
        return share(number, job);
    if (job.attempt == 1 || !job.event->own())
        return std::nullopt;
    Share own = *job.event->own();
    own.attempt = job.attempt;
    return own;
}

/// The last attempt and its receiver, since several plain receivers may fail at one event.
std::optional<Share> Subscription::failed(std::int64_t number, const Job& job) const
{
    auto share = told(number, job);
    if (!share)
        share = job.event->own();
    if (share && !share->group())
        share->to = kind_.receiver;
    return share;
}

Share Subscription::standing() const
{
    return {.of = kind_.shared_as,
            .epoch = kind_.epoch,
            .turn = jobs_,
            .closed = open_.empty() ? jobs_ : open_.begin()->first - 1};
}

void Subscription::request(ReceiverId id, const Progress& progress, const std::vector<std::int64_t>& returned,
                           Clock::time_point now, Decisions& decisions)
{
    const auto found = consumers_.find(id);
    if (found == consumers_.end())
        return;
    Consumer& consumer = found->second;
    const auto first = consumer.credit.done() + 1;
    for (const auto number : returned)
        if (shared() && number >= first && number <= consumer.credit.sent())
            pass_on(consumer, consumer.hands[static_cast<std::size_t>(number - first)], false, false);
    const auto news = consumer.credit.request(progress);
    if (news.asked > 0)
        consumer.asked_at = ++order_;
    if (news.worked > 0) {
        recent_times_[times_++ % recent_times_.size()] = now - consumer.head_since;
        consumer.head_since = now;
        consumer.suspect = false;
    }
    acknowledge(consumer, news.done);
    if (!returned.empty())
        settle(decisions);
    pump(now, decisions);
}

void Subscription::written(ReceiverId id, std::size_t bytes, Clock::time_point now, Decisions& decisions)
{
    if (const auto found = consumers_.find(id); found != consumers_.end())
        found->second.credit.written(bytes);
    pump(now, decisions);
}

void Subscription::acknowledge(Consumer& consumer, std::int64_t count)
{
    for (; count > 0; --count) {
        const Handed handed = std::move(consumer.hands.front());
        consumer.hands.pop_front();
        if (consumer.own && !handed.passed_on)
            consumer.own->ledger.went(Fate::acknowledged);
        close(handed.job, Fate::acknowledged);
    }
}

/// Once: answers of other consumers to this job are ignored.
void Subscription::close(std::int64_t job, Fate fate)
{
    if (open_.erase(job) == 0)
        return;
    again_.erase(job);
    count(fate);
}

/// @param failed  the work failed, not the connection
/// @param holds   the consumer may still answer
void Subscription::pass_on(Consumer& consumer, Handed& handed, bool failed, bool holds)
{
    const bool first_time = !std::exchange(handed.passed_on, true);
    if (consumer.own && first_time)
        consumer.own->ledger.went(Fate::passed_on);
    const auto found = open_.find(handed.job);
    if (!holds)
        handed.job = 0;
    if (found == open_.end())
        return;
    Job& job = found->second;
    job.holders -= holds ? 0 : 1;
    job.failures += failed ? 1 : 0;
    if (first_time && kind_.redelivers && job.failures < max_failures)
        again_.insert(found->first);
}

/// Jobs that no consumer can answer any more are dispatched again, or given up if they failed too often.
void Subscription::settle(Decisions& decisions)
{
    if (!shared())
        return;
    for (auto it = open_.begin(); it != open_.end();) {
        const auto& [number, job] = *it++;
        if (job.holders > 0 || again_.contains(number))
            continue;
        if (kind_.redelivers && job.failures < max_failures)
            again_.insert(number);
        else
            abandon(number, decisions);
    }
}

void Subscription::abandon(std::int64_t number, Decisions& decisions)
{
    const Job& job = open_.at(number);
    if (kind_.redelivers)
        decisions.failed.push_back(job.event->given_up(failed(number, job)));
    close(number, Fate::abandoned);
}

// --- leases and ends ---

Clock::duration Subscription::measured_lease() const
{
    constexpr auto unknown_lease = std::chrono::seconds(30), min_lease = std::chrono::seconds(2);
    constexpr std::size_t times_needed = 3;
    if (times_ < times_needed)
        return unknown_lease;
    return std::max<Clock::duration>(min_lease, 4 * *std::ranges::max_element(recent_times_));
}

/// The shortest lease that any consumer asks for, so that none keeps work from the others for longer; the measured
/// lease for those that ask for none.
Clock::duration Subscription::lease() const
{
    auto shortest = Clock::duration::max();
    for (const auto& [id, consumer] : consumers_)
        shortest =
            std::min(shortest, consumer.options.lease ? Clock::duration(*consumer.options.lease) : measured_lease());
    return shortest;
}

void Subscription::tick(Clock::time_point now, Decisions& decisions)
{
    missed_more_ = false;
    if (awaited_ && awaited_until_ && *awaited_until_ <= now)
        stop_waiting();
    if (!shared())
        return;
    const auto lease = this->lease();
    for (auto& [id, consumer] : consumers_) {
        if (consumer.suspect || !consumer.works() || now - consumer.head_since < lease)
            continue;
        consumer.suspect = true;
        show_hands(id, consumer, decisions);
        for (auto i = consumer.hands.size(); i-- > consumer.head();)
            if (!consumer.hands[i].passed_on)
                pass_on(consumer, consumer.hands[i], i == consumer.head(), true);
    }
    settle(decisions);
    pump(now, decisions);
}

void Subscription::end(Clock::time_point now, Decisions& decisions)
{
    ended_ = true;
    pump(now, decisions);
}

void Subscription::go_on(Decisions& decisions)
{
    ended_ = false;
    revoke_end(decisions);
}

void Subscription::revoke_end(Decisions& decisions)
{
    for (auto& [id, consumer] : consumers_)
        if (std::exchange(consumer.told_end, false) && !consumer.retired)
            decisions.revoked.push_back(id);
}

bool Subscription::told_end(ReceiverId id) const
{
    const auto found = consumers_.find(id);
    return found != consumers_.end() && found->second.told_end;
}

/// In a shared subscription any consumer may still get another's events.
void Subscription::tell_end(Decisions& decisions)
{
    if (!ended_ || waiting() > 0 || (shared() && !open_.empty()))
        return;
    for (auto& [id, consumer] : consumers_)
        if (!consumer.retired && !std::exchange(consumer.told_end, true))
            decisions.ends.push_back(id);
}

}  // namespace hive::event
