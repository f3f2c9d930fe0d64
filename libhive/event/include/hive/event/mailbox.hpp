// The one queue between the network thread and the user thread.
#pragma once

#include <hive/event.hpp>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <variant>

namespace hive::event {

/// Thread-safe. Commands (parameter changes, control) overtake events.
class Mailbox {
public:
    using Command = std::function<void()>;
    using Item = std::variant<Command, Event>;
    using Clock = std::chrono::steady_clock;

    static constexpr std::size_t most_events = 1024;
    static constexpr std::size_t most_bytes = 64u << 20;  ///< beyond two events
    /// Bounds of the events that may not be lost: no sender that keeps to its credit comes near.
    static constexpr std::size_t most_lossless_events = 4096;
    static constexpr std::size_t most_lossless_bytes = 512u << 20;

    void push(Command command);
    /// Over the bounds the oldest event that may be lost goes; returns how many did.
    std::size_t push(Event event);
    /// Ends a pop() that waits, without an item.
    void nudge();

    /// The next item; nothing when the deadline passed or somebody nudged. @param events  false: commands only
    std::optional<Item> pop(Clock::time_point deadline, bool events = true);
    /// Removes the events that may be lost (not lossless) and returns how many.
    std::size_t discard_live();
    [[nodiscard]] std::size_t events() const;

private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Command> commands_;
    std::deque<Event> events_;
    std::size_t bytes_ = 0;
    bool nudged_ = false;
};

}  // namespace hive::event
