// A bounded queue of events with a lane for commands.
#include <hive/event/mailbox.hpp>
#include <hive/event/ticket.hpp>

#include <algorithm>

namespace hive::event {

/// @return  the row of its output; null: it is lossless
Mailbox::Load* Mailbox::add(const Event& event)
{
    bytes_ += event.body.size();
    if (event.identity.lossless)
        return nullptr;
    const auto origin = std::tie(event.sender, event.output);
    auto row = live_.find(origin);
    if (row == live_.end()) {
        if (live_.size() > most_events)
            std::erase_if(live_, [](const auto& each) { return each.second.events == 0; });
        row = live_.emplace(origin, Load{}).first;
    }
    ++row->second.events;
    row->second.bytes += event.body.size();
    return &row->second;
}

void Mailbox::subtract(const Waiting& waiting)
{
    const auto bytes = waiting.event.body.size();
    bytes_ -= bytes;
    if (waiting.load) {
        --waiting.load->events;
        waiting.load->bytes -= bytes;
    }
}

/// The oldest event of the output with the most; end() if all are lossless.
std::deque<Mailbox::Waiting>::iterator Mailbox::to_drop(std::size_t Load::*what)
{
    const auto most = std::ranges::max_element(live_, {}, [what](const auto& row) { return row.second.*what; });
    return most == live_.end() ? events_.end() : std::ranges::find(events_, &most->second, &Waiting::load);
}

void Mailbox::push(Command command)
{
    const std::lock_guard lock(mutex_);
    commands_.push_back(std::move(command));
    waiting_commands_ = commands_.size();
}

void Mailbox::push(Event&& event)
{
    std::vector<Event> dropped;  // destroyed after the lock, since tickets run code
    const std::lock_guard lock(mutex_);
    auto* const load = add(event);
    events_.emplace_back(std::move(event), load);
    while (events_.size() > most_events || (events_.size() > 2 && bytes_ > most_bytes)) {
        const auto oldest = to_drop(events_.size() > most_events ? &Load::events : &Load::bytes);
        if (oldest == events_.end())
            break;
        conclude(oldest->event, Ending::dropped);
        subtract(*oldest);
        dropped.push_back(std::move(oldest->event));
        events_.erase(oldest);
    }
    waiting_events_ = events_.size();
}

/// Called after each handler of the loop, so it takes no lock.
bool Mailbox::ready(bool events) const { return nudged_ || waiting_commands_ > 0 || (events && waiting_events_ > 0); }

std::optional<Mailbox::Item> Mailbox::pop(bool events)
{
    std::optional<Item> item;
    const std::lock_guard lock(mutex_);
    if (!commands_.empty()) {
        item.emplace(std::move(commands_.front()));
        commands_.pop_front();
        waiting_commands_ = commands_.size();
    } else if (events && !events_.empty()) {
        subtract(events_.front());
        item.emplace(std::move(events_.front().event));
        events_.pop_front();
        waiting_events_ = events_.size();
    } else {
        nudged_ = false;
    }
    return item;
}

void Mailbox::discard(const std::function<bool(const Event&)>& fits)
{
    std::vector<Event> discarded;  // destroyed after the lock
    const std::lock_guard lock(mutex_);
    std::deque<Waiting> kept;
    for (auto& waiting : events_)
        if (fits(waiting.event)) {
            conclude(waiting.event, Ending::discarded);
            subtract(waiting);
            discarded.push_back(std::move(waiting.event));
        } else {
            kept.push_back(std::move(waiting));
        }
    events_ = std::move(kept);
    waiting_events_ = events_.size();
}

std::int64_t Mailbox::count(const std::function<bool(const Event&)>& fits) const
{
    const std::lock_guard lock(mutex_);
    return std::ranges::count_if(events_, fits, &Waiting::event);
}

}  // namespace hive::event
