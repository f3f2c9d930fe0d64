// Finds events in a line, and decides what can still arrive.
#include <hive/event/waiting_line.hpp>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <tuple>
#include <utility>

namespace hive::event {

bool WaitingLine::precedes(const std::string& source, const Place& one, const Place& other) const
{
    return one.epoch == other.epoch ? std::tie(one.sequence, one.part) < std::tie(other.sequence, other.part)
                                    : runs_->precedes(source, one.epoch, other.epoch);
}

void WaitingLine::add(Event event, TimePoint due)
{
    bytes_ += event.body.size();
    events_.push_back({std::move(event), due});
}

Event WaitingLine::take(std::size_t place)
{
    const auto found = events_.begin() + static_cast<std::ptrdiff_t>(place);
    Event event = std::move(found->event);
    events_.erase(found);
    bytes_ -= event.body.size();
    return event;
}

bool WaitingLine::overfull() const
{
    const bool lossless = !events_.empty() && events_.front().event.identity.lossless;
    return events_.size() > (lossless ? most_lossless : most_live)
           || (events_.size() > 1 && bytes_ > (lossless ? most_lossless_bytes : most_live_bytes));
}

WaitingLine::Sender& WaitingLine::sender_of(const Event& event)
{
    const auto found = std::ranges::find_if(senders_, [&](const Sender& each) {
        return each.drone == event.sender && each.output == event.output && each.source == event.identity.source;
    });
    if (found != senders_.end())
        return *found;
    if (senders_.size() == most_senders)
        senders_.erase(std::ranges::min_element(senders_, {}, &Sender::heard_at));
    return senders_.emplace_back(
        Sender{.drone = event.sender, .output = event.output, .source = event.identity.source, .place = {}});
}

void WaitingLine::hear(const Event& event, TimePoint now)
{
    heard_at_ = now;
    Sender& sender = sender_of(event);
    sender.heard_at = now;
    const bool again = std::exchange(sender.silent, false);
    sender.shares = event.identity.shared_work() != nullptr;
    const auto place = place_of(event.identity);
    runs_->hear(sender.source, place.epoch, sender.shares ? 0 : sender.place.epoch);
    if (!sender.shares || again || precedes(sender.source, sender.place, place))
        sender.place = place;
    const auto until =
        sender.shares && !again ? std::max(sender.captured_us, event.identity.captured_us) : event.identity.captured_us;
    for (auto& each : senders_)  // one time for all sources whose events come through one drone
        if (each.drone == event.sender && each.output == event.output)
            each.captured_us = until;
}

void WaitingLine::leave_out_silent_senders(TimePoint before)
{
    for (auto& each : senders_)
        each.silent = each.silent || each.heard_at < before;
}

std::optional<std::size_t> WaitingLine::find(const Identity& identity) const
{
    const auto found = std::ranges::find_if(events_, [&](const Waiting& each) {
        const Identity& other = each.event.identity;
        return other.sequence == identity.sequence && other.part == identity.part && other.epoch == identity.epoch
               && other.source == identity.source;
    });
    return found == events_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - events_.begin()));
}

bool WaitingLine::passed(const Identity& identity) const
{
    bool known = false;
    for (const auto& each : senders_)
        if (!each.silent && each.source == identity.source) {
            if (each.shares || precedes(each.source, each.place, place_of(identity)))
                return false;
            known = true;
        }
    return known;
}

bool WaitingLine::overtook(const Identity& identity) const
{
    return std::ranges::any_of(senders_, [&](const Sender& each) {
        return !each.silent && each.source == identity.source && precedes(each.source, place_of(identity), each.place);
    });
}

std::optional<std::size_t> WaitingLine::nearest(std::int64_t captured_us) const
{
    const auto found = std::ranges::min_element(
        events_, {}, [&](const Waiting& each) { return std::abs(each.event.identity.captured_us - captured_us); });
    return found == events_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - events_.begin()));
}

std::optional<std::int64_t> WaitingLine::heard_until() const
{
    std::optional<std::int64_t> until;
    for (const auto& each : senders_)
        if (!each.silent)
            until = std::min(until.value_or(each.captured_us), each.captured_us);
    return until;
}

}  // namespace hive::event
