// The one queue between the network side and the user thread.
#pragma once

#include <hive/event.hpp>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <variant>

namespace hive::event {

/// Thread-safe, and waits for nobody: see Module::next. Commands (parameter changes, control) overtake events.
class Mailbox {
public:
    using Command = std::function<void()>;
    using Item = std::variant<Command, Event>;

    static constexpr std::size_t most_events = 1024;
    static constexpr std::size_t most_bytes = 64u << 20;  ///< beyond two events

    void push(Command command);
    /// Over the bounds an event that may be lost is dropped: the oldest of the output that has most here, so that a
    /// flood costs nobody else's events. One that may not is bounded by the credit that its sender has.
    void push(Event&& event);
    /// Makes it ready() without an item, until the next pop().
    void nudge();

    /// Is there an item, or was it nudged? @param events  false: only commands count
    [[nodiscard]] bool ready(bool events = true) const;
    /// The next item, if there is one. @param events  false: commands only
    std::optional<Item> pop(bool events = true);
    /// Removes the events that fit; they count as discarded.
    void discard(const std::function<bool(const Event&)>& fits);
    /// How many events wait, and how many of them fit.
    [[nodiscard]] std::size_t events() const;
    [[nodiscard]] std::int64_t count(const std::function<bool(const Event&)>& fits) const;

private:
    mutable std::mutex mutex_;
    std::deque<Command> commands_;
    struct Load {
        std::size_t events = 0, bytes = 0;
    };
    void add(const Event& event);
    void subtract(const Event& event);
    std::deque<Event>::iterator to_drop(std::size_t Load::*what);

    std::deque<Event> events_;
    std::size_t bytes_ = 0;
    std::map<std::string, Load> live_;  ///< of them, what may be lost, by the output that it came from
    bool nudged_ = false;
};

}  // namespace hive::event
