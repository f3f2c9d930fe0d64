// A bounded queue of events with a lane for commands.
#include <hive/event/mailbox.hpp>

#include <algorithm>

namespace hive::event {

void Mailbox::push(Command command)
{
    const std::lock_guard lock(mutex_);
    commands_.push_back(std::move(command));
}

std::size_t Mailbox::push(Event&& event)
{
    std::vector<Event> lost;  // destroyed after the lock: receipts have work to do
    const std::lock_guard lock(mutex_);
    bytes_ += event.body.size();
    events_.push_back(std::move(event));
    while (events_.size() > most_events || (events_.size() > 2 && bytes_ > most_bytes)) {
        auto oldest = std::ranges::find_if(events_, [](const Event& e) { return !e.identity.lossless; });
        if (oldest == events_.end() && events_.size() <= most_lossless_events && bytes_ <= most_lossless_bytes)
            break;
        if (oldest == events_.end())
            oldest = events_.begin();
        bytes_ -= oldest->body.size();
        lost.push_back(std::move(*oldest));
        events_.erase(oldest);
    }
    return lost.size();
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
        bytes_ -= events_.front().body.size();
        std::optional<Item> item(std::in_place, std::move(events_.front()));
        events_.pop_front();
        return item;
    }
    nudged_ = false;
    return std::nullopt;
}

std::size_t Mailbox::discard_live()
{
    std::deque<Event> lost;
    const std::lock_guard lock(mutex_);
    std::deque<Event> kept;
    for (auto& event : events_)
        (event.identity.lossless ? kept : lost).push_back(std::move(event));
    events_ = std::move(kept);
    bytes_ = 0;
    for (const auto& event : events_)
        bytes_ += event.body.size();
    return lost.size();
}

std::size_t Mailbox::events() const
{
    const std::lock_guard lock(mutex_);
    return events_.size();
}

}  // namespace hive::event
