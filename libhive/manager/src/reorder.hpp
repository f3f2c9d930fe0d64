// Puts the results of several workers back into the order of the captures: of shared work by its turns, which have no
// gaps even when the source skips; of a source on demand by its sequence. Pure logic: no clock of its own.
#pragma once

#include <hive/event.hpp>

#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

namespace hive {

class Reorder {
public:
    using TimePoint = std::chrono::steady_clock::time_point;

    static constexpr std::size_t live_window = 64;  ///< live results waiting for an earlier one, at most
    static constexpr std::chrono::milliseconds live_patience{1000};
    static constexpr std::chrono::milliseconds first_patience{2000};  ///< for results before the first that came
    static constexpr std::size_t remembered_gaps = 1000;

    explicit Reorder(std::chrono::milliseconds patience) : patience_(patience) {}

    /// What comes after its place was given up (it is counted as missing), or from before the first that was handed
    /// out, is left out.
    void push(Event event, TimePoint now);
    /// This capture has no result: it was reported as failed.
    void fail(const Identity& identity, TimePoint now);
    /// Gives up what has been waited for too long.
    void expire(TimePoint now);
    /// The next event in order, if it is here.
    std::optional<Event> pop();
    /// When expire() may have something to do.
    [[nodiscard]] std::optional<TimePoint> deadline() const;
    [[nodiscard]] std::int64_t missing() const noexcept { return missing_; }
    [[nodiscard]] std::int64_t failed() const noexcept { return failed_; }

private:
    struct Line {                   ///< one source in one epoch, one group
        std::int64_t expected = 0;  ///< 0: nothing has come yet
        std::int64_t first = 0;     ///< the first that was handed out; 0: none was
        bool lossless = false;
        std::multimap<std::pair<std::int64_t, int>, Event>
            waiting;  ///< by number and part; several outputs may have the same
        std::set<std::int64_t> failed;
        std::map<std::int64_t, std::int64_t> given_up;  ///< from, and where it goes on
        TimePoint stuck_since{};

        [[nodiscard]] bool passed(std::int64_t sequence) const;
    };
    void advance(Line& line, TimePoint now);
    void give_up(Line& line, std::int64_t next);
    [[nodiscard]] std::chrono::milliseconds patience_of(const Line& line) const;

    std::chrono::milliseconds patience_;
    using Key = std::tuple<std::string, std::int64_t, std::string>;
    static Key key_of(const Identity& identity) { return {identity.source, identity.epoch, identity.group}; }
    static std::int64_t number_of(const Identity& identity)
    {
        return identity.group.empty() ? identity.sequence : identity.turn;
    }

    std::map<Key, Line> lines_;
    std::deque<Event> ready_;
    std::int64_t missing_ = 0, failed_ = 0;
};

}  // namespace hive
