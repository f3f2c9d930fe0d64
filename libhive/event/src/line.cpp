// What a plain receiver gets when, and what becomes of it.
#include <hive/event/line.hpp>
#include <hive/protocol/defended.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

Line::Line(ReceiverId id, std::string receiver, std::int64_t epoch, const ConnectionOptions& options, Ledger& ledger,
           bool guest)
    : id_(id),
      receiver_(std::move(receiver)),
      epoch_(epoch),
      options_(options),
      ledger_(&ledger),
      credit_(options),
      guest_(guest)
{
}

void Line::wait(Item item, bool first)
{
    waiting_bytes_ += item.event->size();
    if (first)
        waiting_.push_front(std::move(item));
    else
        waiting_.push_back(std::move(item));
}

Line::Item Line::next()
{
    Item item = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= item.event->size();
    return item;
}

void Line::offer(const EmissionPtr& event, Clock::time_point now, Decisions& decisions)
{
    lossless_ = must_stay(event);
    if (kept() && !*lossless_)
        return;  // it would be old when the receiver is back
    ledger_->came();
    go_on();
    if (!credit_.streaming() && !must_stay(event) && !waiting_.empty() && !must_stay(waiting_.back().event)) {
        waiting_bytes_ -= waiting_.back().event->size();
        waiting_.pop_back();
        ledger_->went(Fate::skipped);
    }
    if (waiting_.empty())
        behind_since_ = now;
    wait({event}, false);
    do
        pump(decisions);
    while (credit_.streaming() && drop_oldest(now));  // what was too large for the lane held up what is not
}

bool Line::overfull(Clock::time_point now) const
{
    static const bool judged = defended("most-behind");
    const bool too_slow = judged && now - behind_since_ >= most_behind;
    return waiting_.size() > most_queued_events || (waiting_.size() > 1 && waiting_bytes_ > most_queued_bytes)
           || (too_slow && waiting_.size() > 2 && waiting_bytes_ > Credit::lane_bytes);
}

bool Line::drop_oldest(Clock::time_point now)
{
    bool dropped = false;
    while (overfull(now)) {
        const auto oldest = std::ranges::find_if(waiting_, [&](const Item& item) { return !must_stay(item.event); });
        if (oldest == waiting_.end())
            break;
        waiting_bytes_ -= oldest->event->size();
        waiting_.erase(oldest);
        ledger_->went(Fate::dropped);
        dropped = true;
    }
    return dropped;
}

void Line::pump(Decisions& decisions)
{
    while (!kept() && !waiting_.empty() && credit_.open(must_stay(waiting_.front().event))
           && credit_.lane_free(waiting_.front().event->size())) {
        Item item = next();
        ++item.attempt;
        credit_.sent(item.event->size());
        decisions.sends.push_back({id_, item.event, options_.delivery, told(item)});
        if (!must_stay(item.event))
            item.event = nullptr;
        in_hand_.push_back(std::move(item));
    }
    if (!kept() && waiting_.empty() && std::exchange(ending_, false))
        decisions.ends.push_back(id_);
}

void Line::end(Decisions& decisions)
{
    ending_ = true;
    pump(decisions);
}

/// The first time all receivers are told the same.
std::optional<Share> Line::told(const Item& item) const
{
    if (item.attempt == 1 || !item.event->own())
        return std::nullopt;
    Share share = *item.event->own();
    share.attempt = item.attempt;
    return share;
}

void Line::request(std::int64_t epoch, const Progress& progress, Decisions& decisions)
{
    if (epoch != epoch_)
        return;
    const auto done = credit_.request(progress).done;
    in_hand_.erase(in_hand_.begin(), in_hand_.begin() + done);
    ledger_->went(Fate::acknowledged, done);
    pump(decisions);
}

void Line::written(std::size_t bytes, Decisions& decisions)
{
    credit_.written(bytes);
    pump(decisions);
}

bool Line::worth_keeping() const
{
    return awaited() && (lossless_.value_or(true) || backlogged() || !std::ranges::all_of(in_hand_, &Line::live));
}

bool Line::lose(Fate how, bool keep, Clock::time_point now)
{
    if (!keep || !worth_keeping()) {
        clear(how);
        return false;
    }
    lost_as_ = how;
    const auto head = static_cast<std::size_t>(credit_.worked_in_hand());
    if (head < in_hand_.size() && how != Fate::lost_connection)
        ++in_hand_[head].failures;  // it may be what the receiver died of
    std::deque<Item> stay;
    for (auto& item : std::exchange(waiting_, {}))
        if (live(item))
            ledger_->went(how);
        else
            stay.push_back(std::move(item));
    waiting_bytes_ = 0;
    for (auto& item : stay)
        wait(std::move(item), false);
    kept_until_ = now + place_kept;
    return true;
}

std::int64_t Line::resume(ReceiverId id, std::int64_t epoch, const ConnectionOptions& options,
                          std::optional<std::int64_t> taken, Decisions& decisions)
{
    id_ = id;
    epoch_ = epoch;
    options_ = options;
    ending_ = false;
    kept_until_.reset();
    if (taken) {
        // It was there all the time: what it has taken and not done it still has in hand.
        const auto count = std::clamp(*taken, credit_.done(), credit_.sent());
        put_back(count);
        credit_.begin(options, count);
        return count;
    }
    put_back(credit_.done());
    std::deque<Item> again;
    while (!waiting_.empty())
        if (Item item = next(); item.failures >= most_failures)
            abandon(item, decisions);
        else
            again.push_back(std::move(item));
    for (auto& item : again)
        wait(std::move(item), false);
    credit_.begin(options, credit_.done());
    return credit_.done();
}

/// What was sent beyond the first `taken` deliveries waits again, in its order.
void Line::put_back(std::int64_t taken)
{
    const auto stay = static_cast<std::size_t>(taken - credit_.done());
    while (in_hand_.size() > stay) {
        if (in_hand_.back().event)
            wait(std::move(in_hand_.back()), true);
        else
            ledger_->went(lost_as_);
        in_hand_.pop_back();
    }
}

void Line::abandon(const Item& item, Decisions& decisions)
{
    ledger_->went(Fate::abandoned);
    std::optional<Share> share = item.event->own();
    if (share)
        share->attempt = item.attempt;
    decisions.failed.push_back(item.event->given_up(share));
}

void Line::expire() { clear(lost_as_); }

void Line::clear(Fate how)
{
    ledger_->went(how, static_cast<std::int64_t>(waiting_.size() + in_hand_.size()));
    waiting_.clear();
    in_hand_.clear();
    waiting_bytes_ = 0;
}

bool Line::asks() const
{
    if (kept())
        return false;
    if (credit_.streaming())
        return waiting_.empty() && credit_.open(true);
    return credit_.missing() > waiting();
}

bool Line::backlogged() const { return !waiting_.empty() && must_stay(waiting_.front().event); }

Reason Line::why() const
{
    if (kept())
        return Reason::place_kept;
    if (!waiting_.empty() && !credit_.lane_free(waiting_.front().event->size()))
        return Reason::lane_full;
    return asks() ? Reason::none : Reason::not_asked;
}

}  // namespace hive::event
