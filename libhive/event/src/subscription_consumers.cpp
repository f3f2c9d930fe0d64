// Attaches and detaches consumers: they leave, are lost, and return.
#include <hive/event/subscription.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

std::int64_t Subscription::attach(ReceiverId id, const ConnectionOptions& options, const Kept& kept, Member* own,
                                  Clock::time_point now, Decisions& decisions)
{
    Consumer consumer{.options = options, .own = own, .credit = Credit(options, kept.held)};
    consumer.asked_at = ++order_;
    consumer.head_since = now;
    if (!shared() && present())
        away_ = Away{.was = std::move(consumers_.extract(consumers_.begin()).mapped()), .how = Fate::lost_connection};
    awaited_ = false;
    if (std::exchange(missing_as_, std::nullopt) && kept.received)
        missed_.count -= std::clamp(*kept.received, unsure_from_, unsure_to_) - unsure_from_;
    if (own) {
        if (auto replaced = consumers_.extract(kept.received ? own->newest : 0); !replaced.empty())
            own->away = Away{.was = std::move(replaced.mapped()), .how = Fate::lost_connection, .since = now};
        own->newest = id;
        if (kept.received && own->away)
            resume(consumer, *std::exchange(own->away, std::nullopt), kept, now, decisions);
        forget_away(*own, now, decisions);
    } else if (away_) {
        resume(consumer, *std::exchange(away_, std::nullopt), kept, now, decisions);
    } else if (!shared()) {
        lossless_.reset();
    }
    const auto behind = consumer.credit.sent();
    consumers_.emplace(id, std::move(consumer));
    pump(now, decisions);
    return behind;
}

/// If it has kept running, it still has the events that it received and did not acknowledge.
void Subscription::resume(Consumer& consumer, Away away, const Kept& kept, Clock::time_point now, Decisions& decisions)
{
    auto& credit = away.was.credit;
    const auto count = kept.received ? std::clamp(*kept.received, credit.done(), credit.sent()) : credit.done();
    if (const auto job = open_.find(away.failed); kept.received && job != open_.end())
        --job->second.failures;  // it was silent, not dead
    shared() ? reclaim(away, count, decisions) : take_back(away, count);
    if (!kept.received)
        abandon_exhausted(decisions);
    credit.begin(consumer.options, count, kept.held);
    consumer.credit = credit;
    consumer.hands = std::move(away.was.hands);
    consumer.suspect = away.was.suspect && consumer.works();
    consumer.head_since = away.was.head_since + (now - away.since);  // its lease did not run meanwhile
}

/// A job that crashed three consumers is not dispatched again.
void Subscription::abandon_exhausted(Decisions& decisions)
{
    for (const auto number : std::set(again_))
        if (open_.at(number).failures >= max_failures)
            abandon(number, decisions);
}

/// Requeues its deliveries after the first `count`; live events ended with the connection.
void Subscription::take_back(Away& away, std::int64_t count)
{
    auto& hands = away.was.hands;
    for (const auto stay = static_cast<std::size_t>(count - away.was.credit.done()); hands.size() > stay;
         hands.pop_back()) {
        if (comes_back(open_.at(hands.back().job)))
            again_.insert(hands.back().job);
        else
            close(hands.back().job, away.how);
    }
}

/// It keeps its first `count` deliveries, alone if they were requeued at its loss and no other consumer has got them.
void Subscription::reclaim(Away& away, std::int64_t count, Decisions& decisions)
{
    auto& hands = away.was.hands;
    const auto stay = static_cast<std::size_t>(count - away.was.credit.done());
    for (std::size_t i = 0; i < hands.size(); ++i) {
        const auto job = open_.find(hands[i].job);
        if (i >= stay) {
            pass_on(away.was, hands[i], false, false);
        } else if (job != open_.end() && hands[i].lost && (again_.erase(job->first) > 0 || job->second.holders == 1)) {
            hands[i].passed_on = hands[i].lost = false;
            away.was.own->ledger.came();
        }
    }
    hands.resize(stay);
    settle(decisions);
}

bool Subscription::may_resume(const Member& member) const
{
    const auto present = consumers_.find(member.newest);
    return member.away || (present != consumers_.end() && !present->second.retired);
}

void Subscription::forget_away(Member& member, Clock::time_point now, Decisions& decisions)
{
    const auto away = std::exchange(member.away, std::nullopt);
    if (!away)
        return;
    for (const auto& handed : away->was.hands)
        if (const auto job = open_.find(handed.job); job != open_.end())
            --job->second.holders;
    settle(decisions);
    pump(now, decisions);
}

void Subscription::detach(ReceiverId id, Fate how, bool returns, Clock::time_point now, Decisions& decisions)
{
    auto consumer = consumers_.extract(id);
    if (consumer.empty())
        return;
    if (how == Fate::lost_killed || how == Fate::lost_cut_off)
        show_hands(id, consumer.mapped(), decisions);
    if (shared())
        let_go(id, consumer.mapped(), how, returns, now);
    if (!present())
        last_one_left(std::move(consumer.mapped()), how, returns, now, decisions);
    settle(decisions);
    pump(now, decisions);
}

/// Requeues the jobs of a consumer of a shared subscription. One that may resume can still answer them.
void Subscription::let_go(ReceiverId id, Consumer& consumer, Fate how, bool returns, Clock::time_point now)
{
    const auto head = consumer.head();
    const bool may_resume = consumer.own && consumer.own->newest == id && returns && how != Fate::lost_left
                            && !(how == Fate::lost_killed && consumer.own->local);
    const bool died = how == Fate::lost_killed || how == Fate::lost_cut_off;
    std::int64_t at_fault = 0;
    for (auto i = consumer.hands.size(); i-- > 0;) {
        Handed& handed = consumer.hands[i];
        handed.live = nullptr;
        if (handed.job == 0)
            continue;
        const bool may_have_answered = how != Fate::lost_left || i < head;
        if (const auto job = open_.find(handed.job); job != open_.end() && may_have_answered)
            job->second.in_doubt = true;
        const bool failed = died && i == head && !handed.passed_on;
        at_fault = failed ? handed.job : at_fault;
        handed.lost = !handed.passed_on;
        pass_on(consumer, handed, failed, may_resume);
    }
    if (!may_resume)
        return;
    consumer.own->away = Away{.was = std::move(consumer), .how = how, .since = now, .failed = at_fault};
}

/// The next consumer starts with new events.
void Subscription::last_one_left(Consumer&& last, Fate how, bool returns, Clock::time_point now, Decisions& decisions)
{
    end_live(shared() ? Fate::skipped : how);
    awaited_ = (returns || (shared() && how != Fate::lost_left)) && worth_keeping();
    if (shared()) {
        if (how == Fate::lost_left && !awaited_)
            give_up(false, decisions);
        return;
    }
    if (!awaited_) {
        if (kind_.application && returns) {
            missing_as_ = how;
            live_missed_until_ = now + kept_for;
            unsure_from_ = unsure_to_ = 0;
        }
        return clear(how);
    }
    const auto failed = how != Fate::lost_connection && last.works() ? last.hands[last.head()].job : 0;
    if (failed != 0)
        ++open_.at(failed).failures;  // it may have crashed the receiver
    awaited_until_ = now + kept_for;
    for (auto& handed : last.hands)
        handed.live = nullptr;
    away_ = Away{.was = std::move(last), .how = how, .since = now, .failed = failed};
}

void Subscription::expect(std::optional<Clock::time_point> until, Missed missed)
{
    missed_ = std::move(missed);
    awaited_ = true;
    awaited_until_ = until;
    if (!shared())
        away_ = Away{.was = {.options = {}, .own = nullptr, .credit = Credit({})}, .how = Fate::lost_connection};
}

void Subscription::go_on_missing(Missed missed)
{
    missed_ = std::move(missed);
    missing_as_ = Fate::lost_connection;
}

void Subscription::stop_waiting()
{
    awaited_ = false;
    const auto away = std::exchange(away_, std::nullopt);
    if (!away)
        return;
    missing_as_ = away->how;
    live_missed_until_ = {};
    for_lossless([this](const EmissionPtr& event) { count_missed(event->event().identity); });
    unsure_from_ = away->was.credit.done();
    unsure_to_ = away->was.credit.sent();
    clear(away->how);
}

void Subscription::cancel(Decisions& decisions)
{
    awaited_ = false;
    missing_as_.reset();
    if (std::exchange(away_, std::nullopt))
        clear(Fate::lost_left);
    if (shared() && !present())
        give_up(false, decisions);
}

/// A job that a lost consumer may have answered is not reported as failed, or it would have two answers; nor is one
/// that a retired consumer still works on: it acknowledges the job, or returns it when it leaves.
void Subscription::give_up(bool also_in_doubt, Decisions& decisions)
{
    if (!shared())
        return clear(Fate::lost_left);
    for (auto it = open_.begin(); it != open_.end();) {
        const auto& [number, job] = *it++;
        if (also_in_doubt || (!job.in_doubt && job.holders == 0))
            abandon(number, decisions);
    }
    while (!fresh_.empty()) {
        const auto event = take_fresh();
        count(Fate::abandoned);
        if (kind_.redelivers)
            decisions.failed.push_back(event);
    }
}

/// Ends all remaining events with this outcome.
void Subscription::clear(Fate how)
{
    count(how, static_cast<std::int64_t>(fresh_.size() + open_.size()));
    fresh_.clear();
    fresh_bytes_ = 0;
    open_.clear();
    again_.clear();
}

/// Moves the job with its original share, since there may be an answer to that.
Subscription::Job Subscription::leave_with(std::int64_t number)
{
    Job job = open_.at(number);
    if (!job.adopted_as)
        job.adopted_as = shared() ? share(number, job) : job.event->own();
    job.holders = 0;
    close(number, Fate::passed_on);
    return job;
}

/// Nothing moves from a passive subscription: its events were only for display, and may have no body.
void Subscription::adopt(Subscription&& other, bool left, Clock::time_point now, Decisions& decisions)
{
    if (other.passive())
        return other.end_live(Fate::lost_left);
    if (auto away = std::exchange(other.away_, std::nullopt)) {
        const auto& hands = away->was.hands;
        for (std::size_t i = 0; i < hands.size(); ++i)
            if (const auto job = other.open_.find(hands[i].job); job != other.open_.end())
                job->second.in_doubt = job->second.in_doubt || !left || i < away->was.head();
        other.take_back(*away, away->was.credit.done());
    }
    other.abandon_exhausted(decisions);
    for (const auto number : std::set(other.again_)) {
        open_[++jobs_] = other.leave_with(number);
        again_.insert(jobs_);
        ledger_.came();
    }
    while (!other.fresh_.empty()) {
        wait(other.take_fresh());
        other.ledger_.went(Fate::passed_on);
        ledger_.came();
    }
    other.awaited_ = false;
    other.missing_as_.reset();
    if (other.missed_.count > 0) {
        other.missed_.count += missed_.count;
        missed_ = std::exchange(other.missed_, {});
    }
    if (waiting() > 0)
        revoke_end(decisions);  // until it has left
    pump(now, decisions);
}

}  // namespace hive::event
