// Giving out jobs, taking them back, closing turns.
#include <hive/event/group.hpp>

#include <algorithm>
#include <tuple>
#include <utility>

namespace hive::event {
namespace {

constexpr auto unknown_lease = std::chrono::seconds(30);
constexpr auto least_lease = std::chrono::seconds(2);
constexpr std::size_t times_needed = 3;
constexpr std::size_t most_lost_names = 64;

}  // namespace

Clock::duration WorkTimes::lease() const
{
    if (count_ < times_needed)
        return unknown_lease;
    return std::max<Clock::duration>(least_lease, 4 * *std::ranges::max_element(recent_));
}

Group::Hand* Group::Member::head()
{
    return unworked() == 0 ? nullptr : &hands[static_cast<std::size_t>(credit.worked_in_hand())];
}

bool Group::Member::holds(std::int64_t turn) const
{
    return turn != 0 && std::ranges::find(hands, turn, &Hand::turn) != hands.end();
}

Clock::duration Group::lease_of(const Member& member) const
{
    return member.options.lease ? Clock::duration(*member.options.lease) : times_.lease();
}

Share Group::share(std::int64_t turn, const Job& job) const
{
    return {.of = of_,
            .epoch = epoch_,
            .turn = turn,
            .attempt = job.attempt,
            .closed = closed(),
            .part = job.event->event().identity.part};
}

void Group::join(ReceiverId id, std::string receiver, std::int64_t epoch, const ConnectionOptions& options,
                 Ledger& ledger, Clock::time_point now, Decisions& decisions)
{
    awaited_ = false;
    lost_.erase(receiver);
    members_.emplace(id, Member{.receiver = std::move(receiver),
                                .epoch = epoch,
                                .options = options,
                                .ledger = &ledger,
                                .credit = Credit(options),
                                .hands = {},
                                .asked_at = ++asking_order_});
    pump(now, decisions);
}

void Group::offer(const EmissionPtr& event, Clock::time_point now, Decisions& decisions)
{
    ledger_->came();
    go_on();
    lossless_ = event->lossless();
    if (!lossless_ && !fresh_.empty() && !fresh_.back()->lossless()) {
        fresh_.pop_back();
        ledger_->went(Fate::skipped);
    }
    fresh_.push_back(event);
    pump(now, decisions);
}

EmissionPtr Group::next_event() const
{
    if (!again_.empty())
        return open_.at(*again_.begin()).event;
    return fresh_.empty() ? nullptr : fresh_.front();
}

/// Who is to have a job: of those with credit that do not have it in hand, the one that has the fewest in hand, then
/// the one that asked first. Who cannot be sent it right now comes last.
Group::Members::iterator Group::choose(std::int64_t turn, std::size_t bytes)
{
    auto best = members_.end();
    const auto rank = [&](const Member& member) {
        return std::tuple(!member.credit.lane_free(bytes), member.hands.size(), member.asked_at);
    };
    for (auto it = members_.begin(); it != members_.end(); ++it) {
        const Member& member = it->second;
        if (member.suspect || !member.credit.open(true) || member.holds(turn))
            continue;
        if (best == members_.end() || rank(member) < rank(best->second))
            best = it;
    }
    return best;
}

/// Older turns go first. One that everybody with credit has in hand waits for somebody else, or for its answer.
void Group::pump(Clock::time_point now, Decisions& decisions)
{
    for (auto waiting = again_.begin(); waiting != again_.end();) {
        const auto turn = *waiting;
        const auto bytes = open_.at(turn).event->size();
        const auto member = choose(turn, bytes);
        if (member == members_.end()) {
            ++waiting;
            continue;
        }
        if (!member->second.credit.lane_free(bytes))
            return;
        waiting = again_.erase(waiting);
        give(member->first, member->second, turn, now, decisions);
    }
    while (!fresh_.empty()) {
        const auto bytes = fresh_.front()->size();
        const auto member = choose(0, bytes);
        if (member == members_.end() || !member->second.credit.lane_free(bytes))
            return;
        open_[++turns_].event = std::move(fresh_.front());
        fresh_.pop_front();
        give(member->first, member->second, turns_, now, decisions);
    }
    tell_end(decisions);
}

/// Not before the others have answered: what they have in hand may still come to any member.
void Group::tell_end(Decisions& decisions)
{
    if (!ended_ || !fresh_.empty() || !open_.empty())
        return;
    for (auto& [id, member] : members_)
        if (!std::exchange(member.told_end, true))
            decisions.ends.push_back(id);
}

void Group::end(Clock::time_point now, Decisions& decisions)
{
    ended_ = true;
    pump(now, decisions);
}

void Group::go_on()
{
    ended_ = false;
    for (auto& [id, member] : members_)
        member.told_end = false;
}

void Group::give(ReceiverId id, Member& member, std::int64_t turn, Clock::time_point now, Decisions& decisions)
{
    Job& job = open_.at(turn);
    ++job.attempt;
    ++job.holders;
    if (member.unworked() == 0)
        member.head_since = now;
    member.credit.sent(job.event->size());
    member.ledger->came();
    member.hands.push_back({turn});
    decisions.sends.push_back({id, job.event, Delivery::data, share(turn, job)});
}

void Group::request(ReceiverId id, std::int64_t epoch, const Progress& progress, const std::vector<std::int64_t>& back,
                    Clock::time_point now, Decisions& decisions)
{
    const auto found = members_.find(id);
    if (found == members_.end() || found->second.epoch != epoch)
        return;
    Member& member = found->second;
    const auto first = member.credit.done() + 1;
    for (const auto number : back)
        if (number >= first && number <= member.credit.sent())
            pass_on(member, member.hands[static_cast<std::size_t>(number - first)], false, false);
    const auto news = member.credit.request(progress);
    if (news.asked > 0)
        member.asked_at = ++asking_order_;
    if (news.worked > 0) {
        times_.add(now - member.head_since);
        member.head_since = now;
        member.suspect = false;
    }
    acknowledge(member, news.done);
    if (!back.empty())
        settle(decisions);
    pump(now, decisions);
}

void Group::acknowledge(Member& member, std::int64_t done)
{
    for (; done > 0; --done) {
        const Hand hand = member.hands.front();
        member.hands.pop_front();
        if (!hand.passed_on)
            member.ledger->went(Fate::acknowledged);
        close(hand.turn);
    }
}

/// A turn has its answer: whoever else works on it answers for nothing.
void Group::close(std::int64_t turn)
{
    if (turn == 0 || open_.erase(turn) == 0)
        return;
    again_.erase(turn);
    ledger_->went(Fate::acknowledged);
}

/// @param failed  the work is to blame
/// @param holds   the member may answer all the same
void Group::pass_on(Member& member, Hand& hand, bool failed, bool holds)
{
    if (!hand.passed_on)
        member.ledger->went(Fate::passed_on);
    const bool again = !std::exchange(hand.passed_on, true);
    const auto job = open_.find(hand.turn);
    if (!holds)
        hand.turn = 0;
    if (job == open_.end())
        return;
    job->second.holders -= holds ? 0 : 1;
    job->second.failures += failed ? 1 : 0;
    if (again && leases_ && job->second.failures < most_failures)
        again_.insert(job->first);
}

/// Gives up the jobs that failed too often once nobody can answer them any more.
void Group::settle(Decisions& decisions)
{
    for (auto it = open_.begin(); it != open_.end();) {
        const auto& [turn, job] = *it;
        if (job.holders > 0 || again_.contains(turn)) {
            ++it;
            continue;
        }
        const Share last = share(turn, job);
        const EmissionPtr event = job.event;
        it = open_.erase(it);
        abandon(event, last, decisions);
    }
}

void Group::abandon(const EmissionPtr& event, const Share& last, Decisions& decisions)
{
    ledger_->went(Fate::abandoned);
    if (leases_)
        decisions.failed.push_back(event->given_up(last));
}

void Group::written(ReceiverId id, std::size_t bytes, Clock::time_point now, Decisions& decisions)
{
    if (const auto found = members_.find(id); found != members_.end())
        found->second.credit.written(bytes);
    pump(now, decisions);
}

void Group::tick(Clock::time_point now, Decisions& decisions)
{
    for (auto& [id, member] : members_) {
        if (member.suspect || !member.head() || now - member.head_since < lease_of(member))
            continue;
        member.suspect = true;
        const auto first = static_cast<std::size_t>(member.credit.worked_in_hand());
        for (auto i = member.hands.size(); i-- > first;)
            if (!member.hands[i].passed_on)
                pass_on(member, member.hands[i], i == first, true);
    }
    settle(decisions);
    pump(now, decisions);
}

/// What a member that goes had in hand waits for another one.
void Group::let_go(Member& member, Fate how)
{
    const auto working = static_cast<std::size_t>(member.credit.worked_in_hand());
    const bool died = how == Fate::lost_killed || how == Fate::lost_cut_off;
    for (auto i = member.hands.size(); i-- > 0;) {
        const auto job = open_.find(member.hands[i].turn);
        if (job != open_.end() && how != Fate::lost_left)
            job->second.in_doubt = true;
        if (member.hands[i].turn != 0)
            pass_on(member, member.hands[i], died && i == working && !member.hands[i].passed_on, false);
    }
}

void Group::leave(ReceiverId id, Clock::time_point now, Decisions& decisions)
{
    auto member = members_.extract(id);
    if (member.empty())
        return;
    let_go(member.mapped(), Fate::lost_left);
    if (members_.empty())
        empty(true, decisions);
    settle(decisions);
    pump(now, decisions);
}

void Group::lose(ReceiverId id, Fate how, Clock::time_point now, Decisions& decisions)
{
    auto member = members_.extract(id);
    if (member.empty())
        return;
    let_go(member.mapped(), how);
    if (lost_.size() < most_lost_names)
        lost_.insert(member.mapped().receiver);
    if (members_.empty())
        empty(false, decisions);
    settle(decisions);
    pump(now, decisions);
}

/// The last member is gone. What a live source made and nobody had is skipped: the next member begins with what is new.
void Group::empty(bool left, Decisions& decisions)
{
    if (!fresh_.empty() && !fresh_.back()->lossless()) {
        fresh_.pop_back();
        ledger_->went(Fate::skipped);
    }
    if (left)
        return give_up(false, decisions);
    const auto lossless = [](const auto& row) { return row.second.event->lossless(); };
    awaited_ = lossless_ || !fresh_.empty() || std::ranges::any_of(open_, lossless);
}

void Group::forget(Decisions& decisions)
{
    awaited_ = false;
    lost_.clear();
    if (members_.empty())
        give_up(false, decisions);
}

void Group::give_up(bool also_in_doubt, Decisions& decisions)
{
    for (auto it = open_.begin(); it != open_.end();) {
        if (it->second.in_doubt && !also_in_doubt) {
            ++it;
            continue;
        }
        const auto given_up = open_.extract(it++);
        again_.erase(given_up.key());
        abandon(given_up.mapped().event, share(given_up.key(), given_up.mapped()), decisions);
    }
    for (const auto& event : std::exchange(fresh_, {})) {
        ledger_->went(Fate::abandoned);
        if (leases_)
            decisions.failed.push_back(event);
    }
}

bool Group::lost(const std::string& drone) const
{
    return std::ranges::any_of(lost_,
                               [&](const std::string& name) { return name == drone || name.starts_with(drone + "."); });
}

bool Group::asks() const
{
    std::int64_t missing = 0;
    for (const auto& [id, member] : members_)
        missing += member.suspect ? 0 : member.credit.missing();
    return missing > waiting();
}

bool Group::backlogged() const
{
    const auto event = next_event();
    return active() && event && event->lossless();
}

bool Group::leasing() const
{
    return std::ranges::any_of(members_, [](const auto& row) { return row.second.unworked() > 0; });
}

Reason Group::why() const
{
    if (awaited_ || (members_.empty() && !open_.empty()))
        return Reason::group_awaited;
    if (members_.empty() || asks())
        return Reason::none;
    const auto exhausted = [](const auto& row) { return row.second.failures >= most_failures; };
    if (std::ranges::any_of(open_, exhausted)
        || std::ranges::any_of(members_, [](const auto& row) { return row.second.suspect; }))
        return Reason::lease_running;
    return Reason::not_asked;
}

Reason Group::why(ReceiverId id) const
{
    const auto found = members_.find(id);
    if (found == members_.end() || found->second.credit.missing() > 0)
        return Reason::none;
    return found->second.suspect ? Reason::lease_running : Reason::not_asked;
}

}  // namespace hive::event
