// Which events of several inputs belong together.
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

    /// What comes of one capture: the same source, epoch, sequence and part.
    static Match exact() { return {}; }
    /// Each event is the nearest, by the time of its capture, to that of the first input, and not farther than this
    /// from it. It is decided when no nearer one can come, so up to one period of the slower input later. Across
    /// machines their clocks must agree.
    static Match within(std::chrono::microseconds tolerance) { return {tolerance}; }

    bool operator==(const Match&) const = default;
};

/// What matching has come to so far.
struct MatchCounts {
    std::int64_t sets = 0;        ///< complete
    std::int64_t waiting = 0;     ///< events, now
    std::int64_t unmatched = 0;   ///< events that found no partner and are gone
    std::int64_t duplicates = 0;  ///< events with the identity of one that was waiting at the same input
    std::map<std::string, std::int64_t> missing = {};  ///< by input: how many of the unmatched found no partner there
};

}  // namespace hive
