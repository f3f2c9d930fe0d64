// The one queue between the network side and the user thread.
#pragma once

#include <hive/event.hpp>

#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <variant>

namespace hive::event {

/// Thread-safe, and waits for nobody: see Module::next. Commands (parameter changes, control) overtake events.
class Mailbox {
public:
    using Command = std::function<void()>;
    using Item = std::variant<Command, Event>;

    static constexpr std::size_t most_events = 1024;
    static constexpr std::size_t most_bytes = 64u << 20;  ///< beyond two events
    /// Bounds of the events that may not be lost: no sender that keeps to its credit comes near.
    static constexpr std::size_t most_lossless_events = 4096;
    static constexpr std::size_t most_lossless_bytes = 512u << 20;

    void push(Command command);
    /// Over the bounds the oldest event that may be lost goes; returns how many did.
    std::size_t push(Event&& event);
    /// Makes it ready() without an item, until the next pop().
    void nudge();

    /// Is there an item, or was it nudged? @param events  false: only commands count
    [[nodiscard]] bool ready(bool events = true) const;
    /// The next item, if there is one. @param events  false: commands only
    std::optional<Item> pop(bool events = true);
    /// Removes the events that may be lost (not lossless) and returns how many.
    std::size_t discard_live();
    [[nodiscard]] std::size_t events() const;

private:
    mutable std::mutex mutex_;
    std::deque<Command> commands_;
    std::deque<Event> events_;
    std::size_t bytes_ = 0;
    bool nudged_ = false;
};

}  // namespace hive::event
