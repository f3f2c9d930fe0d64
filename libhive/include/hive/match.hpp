// The rule by which events of several inputs are matched.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace hive {

/// The rule by which events of several inputs make a set.
struct Match {
    std::optional<std::chrono::microseconds> tolerance;  ///< empty: exact

    /// Events of one capture: the same source, epoch, sequence and part.
    static Match exact() { return {}; }
    /// Each event is the nearest by capture time to the event of the first input, and at most `tolerance` away from it.
    /// A set is complete only when no nearer event can come: up to one period of the slower input later. Clocks of
    /// different machines must agree.
    static Match within(std::chrono::microseconds tolerance) { return {tolerance}; }

    bool operator==(const Match&) const = default;
};

/// Counters of a matching.
struct MatchCounts {
    std::int64_t sets = 0;        ///< complete
    std::int64_t waiting = 0;     ///< events, now
    std::int64_t unmatched = 0;   ///< events dropped without a partner
    std::int64_t duplicates = 0;  ///< events with the identity of one that was waiting at the same input
    std::map<std::string, std::int64_t> missing = {};  ///< by input: how many of the unmatched found no partner there
};

}  // namespace hive
