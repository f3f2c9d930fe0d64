// The one queue between the network side and the user thread.
#pragma once

#include <hive/event.hpp>

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <variant>

namespace hive::event {

/// Thread-safe, never blocks: see Module::next. Commands (parameter changes, control) overtake events.
class Mailbox {
public:
    using Command = std::function<void()>;
    using Item = std::variant<Command, Event>;

    static constexpr std::size_t most_events = 1024;
    static constexpr std::size_t most_bytes = 64u << 20;  ///< beyond two events

    void push(Command command);
    /// Over the bounds a live event is dropped: the oldest of the output with the most events here, so that a flood
    /// does not displace other events. Lossless events are bounded by the credit of their sender.
    void push(Event&& event);
    /// Makes it ready() without an item, until the next pop().
    void nudge() { nudged_ = true; }

    /// Is there an item, or was it nudged? @param events  false: only commands count
    [[nodiscard]] bool ready(bool events = true) const;
    /// The next item, if there is one. @param events  false: commands only
    std::optional<Item> pop(bool events = true);
    /// Removes the matching events; they count as discarded.
    void discard(const std::function<bool(const Event&)>& fits);
    /// The number of waiting events, and of the matching ones among them.
    [[nodiscard]] std::size_t events() const { return waiting_events_; }
    [[nodiscard]] std::int64_t count(const std::function<bool(const Event&)>& fits) const;

private:
    mutable std::mutex mutex_;
    std::deque<Command> commands_;
    struct Load {
        std::size_t events = 0, bytes = 0;
    };
    struct Waiting {
        Waiting(Event&& arrived, Load* of_output) : event(std::move(arrived)), load(of_output) {}
        Event event;
        Load* load;  ///< null: it is lossless
    };
    Load* add(const Event& event);
    void subtract(const Waiting& waiting);
    std::deque<Waiting>::iterator to_drop(std::size_t Load::*what);

    std::deque<Waiting> events_;
    std::size_t bytes_ = 0;
    /// The live ones, by sender and output. Rows without events stay for the next one.
    std::map<std::tuple<std::string, std::string>, Load, std::less<>> live_;
    std::atomic<std::size_t> waiting_commands_ = 0, waiting_events_ = 0;  ///< the sizes of the two queues
    std::atomic<bool> nudged_ = false;
};

}  // namespace hive::event
