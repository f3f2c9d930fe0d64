// The status of a subscription: its demand, its waiting events, and its stall reason.
#include <hive/event/subscription.hpp>

#include <algorithm>

namespace hive::event {

bool Subscription::asks() const
{
    if (streams())
        return waiting() == 0 && consumers_.begin()->second.credit.open(true);
    std::int64_t missing = 0;
    for (const auto& [id, consumer] : consumers_)
        missing += consumer.suspect || consumer.retired ? 0 : consumer.credit.missing();
    return missing > waiting();
}

EmissionPtr Subscription::next() const
{
    if (!again_.empty())
        return open_.at(*again_.begin()).event;
    return fresh_.empty() ? nullptr : fresh_.front();
}

bool Subscription::backlogged() const
{
    const auto event = next();
    return event && (present() || awaited_) && must_arrive(event);
}

bool Subscription::timed() const
{
    return missed_more_ || (awaited_ && awaited_until_)
           || (shared() && std::ranges::any_of(consumers_, [](const auto& row) { return row.second.works(); }));
}

/// True if all consumers that may get the event have full connections.
bool Subscription::lanes_full(const Emission& event) const
{
    std::int64_t lanes = 0;
    for (const auto& [id, consumer] : consumers_) {
        const bool may_get = !consumer.suspect && !consumer.retired && consumer.credit.missing() > 0;
        if (shared() && !may_get)
            continue;
        if (consumer.credit.lane_free(event.size()))
            return false;
        ++lanes;
    }
    return lanes > 0;
}

Reason Subscription::why() const
{
    if (!present() && retiring())  // its returned events move along when it has acknowledged the rest
        return has_waiting() ? Reason::not_acknowledged : Reason::none;
    if (!present()) {
        const bool waits = awaited_ || !open_.empty();
        return !waits ? Reason::none : shared() ? Reason::group_awaited : Reason::place_kept;
    }
    if (const auto event = next(); event && lanes_full(*event))
        return Reason::lane_full;
    const bool exhausted =
        std::ranges::any_of(open_, [](const auto& row) { return row.second.failures >= max_failures; });
    if (ended_ && shared() && exhausted)  // the end waits, also if the member that may answer is away
        return Reason::lease_running;
    if (asks())
        return Reason::none;
    const bool suspect = std::ranges::any_of(consumers_, [](const auto& row) { return row.second.suspect; });
    if (std::ranges::all_of(consumers_, [](const auto& row) { return row.second.credit.full(); }))
        return Reason::not_acknowledged;
    return shared() && (exhausted || suspect) ? Reason::lease_running : Reason::not_asked;
}

Reason Subscription::why(ReceiverId consumer) const
{
    const auto found = consumers_.find(consumer);
    if (found == consumers_.end() || found->second.credit.missing() > 0)
        return Reason::none;
    return found->second.suspect         ? Reason::lease_running
           : found->second.credit.full() ? Reason::not_acknowledged
                                         : Reason::not_asked;
}

}  // namespace hive::event
