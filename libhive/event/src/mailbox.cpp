// A bounded queue of events with a lane for commands.
#include <hive/event/mailbox.hpp>
#include <hive/event/ticket.hpp>

#include <algorithm>

namespace hive::event {

namespace {

std::string origin_of(const Event& event) { return event.sender + "." + event.output; }

}  // namespace

void Mailbox::add(const Event& event)
{
    bytes_ += event.body.size();
    if (event.identity.lossless)
        return;
    auto& load = live_[origin_of(event)];
    ++load.events;
    load.bytes += event.body.size();
}

void Mailbox::subtract(const Event& event)
{
    bytes_ -= event.body.size();
    if (event.identity.lossless)
        return;
    const auto row = live_.find(origin_of(event));
    row->second.bytes -= event.body.size();
    if (--row->second.events == 0)
        live_.erase(row);
}

/// The oldest event of the output with the most; end() if all are lossless.
std::deque<Event>::iterator Mailbox::to_drop(std::size_t Load::*what)
{
    if (live_.empty())
        return events_.end();
    const auto& origin =
        std::ranges::max_element(live_, {}, [what](const auto& row) { return row.second.*what; })->first;
    return std::ranges::find_if(
        events_, [&](const Event& each) { return !each.identity.lossless && origin_of(each) == origin; });
}

void Mailbox::push(Command command)
{
    const std::lock_guard lock(mutex_);
    commands_.push_back(std::move(command));
}

void Mailbox::push(Event&& event)
{
    std::vector<Event> dropped;  // destroyed after the lock, since tickets run code
    const std::lock_guard lock(mutex_);
    add(event);
    events_.push_back(std::move(event));
    while (events_.size() > most_events || (events_.size() > 2 && bytes_ > most_bytes)) {
        const auto oldest = to_drop(events_.size() > most_events ? &Load::events : &Load::bytes);
        if (oldest == events_.end())
            break;
        conclude(*oldest, Ending::dropped);
        subtract(*oldest);
        dropped.push_back(std::move(*oldest));
        events_.erase(oldest);
    }
}

void Mailbox::nudge()
{
    const std::lock_guard lock(mutex_);
    nudged_ = true;
}

bool Mailbox::ready(bool events) const
{
    const std::lock_guard lock(mutex_);
    return nudged_ || !commands_.empty() || (events && !events_.empty());
}

std::optional<Mailbox::Item> Mailbox::pop(bool events)
{
    const std::lock_guard lock(mutex_);
    if (!commands_.empty()) {
        Command command = std::move(commands_.front());
        commands_.pop_front();
        return command;
    }
    if (events && !events_.empty()) {
        subtract(events_.front());
        std::optional<Item> item(std::in_place, std::move(events_.front()));
        events_.pop_front();
        return item;
    }
    nudged_ = false;
    return std::nullopt;
}

void Mailbox::discard(const std::function<bool(const Event&)>& fits)
{
    std::vector<Event> discarded;  // destroyed after the lock
    const std::lock_guard lock(mutex_);
    std::deque<Event> kept;
    for (auto& event : events_)
        if (fits(event)) {
            conclude(event, Ending::discarded);
            subtract(event);
            discarded.push_back(std::move(event));
        } else {
            kept.push_back(std::move(event));
        }
    events_ = std::move(kept);
}

std::size_t Mailbox::events() const
{
    const std::lock_guard lock(mutex_);
    return events_.size();
}

std::int64_t Mailbox::count(const std::function<bool(const Event&)>& fits) const
{
    const std::lock_guard lock(mutex_);
    return std::ranges::count_if(events_, fits);
}

}  // namespace hive::event
