// One input of a Matcher: the events that wait for their partners, and the progress of each sender of the input.
#pragma once

#include <hive/event.hpp>
#include <hive/event/clock.hpp>
#include <hive/event/runs.hpp>

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hive::event {

/// Pure logic, for one thread.
class WaitingLine {
public:
    using TimePoint = Clock::time_point;

    /// Live events: enough for a detector with a second or two of latency at 30 fps, and affordable for a process. A
    /// waiting image holds a slot of its sender's shared memory, or memory of this process when it holds too many
    /// slots.
    static constexpr std::size_t most_live = 128, most_live_bytes = 128u << 20;
    /// Lossless events: the same as a Mailbox; a source that waits for its receivers stays far below.
    static constexpr std::size_t most_lossless = 4096, most_lossless_bytes = 512u << 20;
    /// Maximum number of senders whose progress is remembered.
    static constexpr std::size_t most_senders = 64;

    struct Waiting {
        Event event;
        TimePoint due;           ///< when it expires
        bool overtaken = false;  ///< its partner is late: a later event arrived at that input
    };

    /// @param runs  those of all inputs
    WaitingLine(std::string input, std::shared_ptr<Runs> runs) : input_(std::move(input)), runs_(std::move(runs)) {}

    [[nodiscard]] const std::string& input() const noexcept { return input_; }
    [[nodiscard]] std::deque<Waiting>& events() noexcept { return events_; }
    [[nodiscard]] const std::deque<Waiting>& events() const noexcept { return events_; }
    void add(Event event, TimePoint due);
    Event take(std::size_t place);
    /// Does it exceed its limits?
    [[nodiscard]] bool overfull() const;

    /// Records the progress of this event's sender.
    void hear(const Event& event, TimePoint now);
    /// Those that were not heard since then pass nothing any more, until they are heard again.
    void leave_out_silent_senders(TimePoint before);
    [[nodiscard]] TimePoint heard_at() const noexcept { return heard_at_; }
    void begin(TimePoint now) { heard_at_ = now; }

    /// The position of the event with this identity.
    [[nodiscard]] std::optional<std::size_t> find(const Identity& identity) const;
    /// Has every sender passed this identity, so that it cannot arrive any more? Never true for workers that share
    /// jobs, since they keep no order.
    [[nodiscard]] bool passed(const Identity& identity) const;
    /// Has any sender passed it?
    [[nodiscard]] bool overtook(const Identity& identity) const;

    /// The position of the event captured nearest to this time; the earlier of two.
    [[nodiscard]] std::optional<std::size_t> nearest(std::int64_t captured_us) const;
    /// The capture time that every sender has reached; nothing when no sender is known.
    [[nodiscard]] std::optional<std::int64_t> heard_until() const;

private:
    struct Place {
        std::int64_t epoch = 0, sequence = 0;
        int part = 0;
    };
    struct Sender {
        std::string drone, output, source;
        Place place;
        std::int64_t captured_us = 0;
        bool shares = false, silent = false;
        TimePoint heard_at{};
    };
    static Place place_of(const Identity& identity) { return {identity.epoch, identity.sequence, identity.part}; }
    Sender& sender_of(const Event& event);
    [[nodiscard]] bool precedes(const std::string& source, const Place& one, const Place& other) const;

    std::string input_;
    std::shared_ptr<Runs> runs_;
    std::deque<Waiting> events_;
    std::size_t bytes_ = 0;
    std::vector<Sender> senders_;
    TimePoint heard_at_{};
};

}  // namespace hive::event
