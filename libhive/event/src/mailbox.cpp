// A bounded queue of events with a lane for commands.
#include <hive/event/mailbox.hpp>
#include <hive/event/receipt.hpp>

#include <algorithm>

namespace hive::event {

void Mailbox::push(Command command)
{
    const std::lock_guard lock(mutex_);
    commands_.push_back(std::move(command));
}

void Mailbox::push(Event&& event)
{
    std::vector<Event> dropped;  // destroyed after the lock: receipts have work to do
    const std::lock_guard lock(mutex_);
    bytes_ += event.body.size();
    events_.push_back(std::move(event));
    while (events_.size() > most_events || (events_.size() > 2 && bytes_ > most_bytes)) {
        const auto oldest = std::ranges::find_if(events_, [](const Event& each) { return !each.identity.lossless; });
        if (oldest == events_.end())
            break;
        conclude(*oldest, Ending::dropped);
        bytes_ -= oldest->body.size();
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
        bytes_ -= events_.front().body.size();
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
            bytes_ -= event.body.size();
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
