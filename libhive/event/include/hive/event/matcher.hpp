// Matches events of several inputs that belong to one capture, or to one moment.
#pragma once

#include <hive/event/waiting_line.hpp>
#include <hive/match.hpp>

#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace hive::event {

/// Pure logic: events and the time in, sets out; for one thread. docs/architecture.md, "Matching", explains which
/// events wait, and which of them keep their tickets.
class Matcher {
public:
    using TimePoint = Clock::time_point;
    using Set = std::vector<Event>;  ///< one event of each input, in their order

    /// How long a live event waits, and how long a silent input delays the source of lossless ones.
    static constexpr std::chrono::seconds timeout{4};
    /// Lossless events that wait at one input without delaying their source, so that a drone that skips one stops
    /// nothing, and the drones on the way work at the same time.
    static constexpr int most_ahead = 4;

    /// @param inputs  two or more
    Matcher(const std::vector<std::string>& inputs, Match match);

    void rule(Match match) { match_ = match; }

    /// An event of the input that its `input` names.
    void push(Event event, TimePoint now);
    /// Gives up events that have waited for too long.
    void expire(TimePoint now);
    /// Nothing more will come: makes the last sets, and gives up the rest.
    void finish();
    /// The next set. The event that completed it is still in processing; the others may not be.
    std::optional<Set> pop();
    /// Is there one?
    [[nodiscard]] bool ready() const noexcept { return !ready_.empty(); }
    /// When expire() must be called next.
    [[nodiscard]] std::optional<TimePoint> deadline() const;
    [[nodiscard]] MatchCounts counts() const;

private:
    using Waiting = WaitingLine::Waiting;
    using Places = std::vector<std::size_t>;

    [[nodiscard]] std::size_t index_of(const std::string& input) const;
    [[nodiscard]] std::optional<std::size_t> partner(const Waiting& waiting, std::size_t other) const;
    [[nodiscard]] bool compared(std::size_t one, std::size_t other) const;
    [[nodiscard]] bool hopeless(const Waiting& waiting, std::size_t other) const;
    [[nodiscard]] bool overtaken(const Waiting& waiting, std::size_t other) const;
    [[nodiscard]] std::optional<std::size_t> nearest_partner(std::size_t first, std::size_t other, TimePoint now) const;
    [[nodiscard]] std::optional<Places> exact_set(const Waiting& newest) const;
    [[nodiscard]] std::optional<Places> nearest_set(TimePoint now) const;
    void make_set(const Places& places);
    void make_nearest_sets(TimePoint now);
    void give_up(std::size_t input, std::size_t place);
    void drop_hopeless(std::size_t input);
    void drop_late(std::size_t input, TimePoint now);
    void give_back(std::size_t input, TimePoint now);
    [[nodiscard]] bool holds_up(const Waiting& waiting, std::size_t input, TimePoint now) const;

    Match match_;
    std::vector<WaitingLine> lines_;
    std::deque<Set> ready_;
    bool begun_ = false;
    MatchCounts counts_;
};

/// The identity of a set's results: that of its first event, with the hops of all, each drone once.
Identity identity_of(const std::vector<Event>& set);

}  // namespace hive::event
