// Sizes that may not grow without end, and times that no drone can have seen.
#pragma once

#include "checks.hpp"

#include <chrono>

namespace hive::mixtures {

/// bounded: queues, events in hand and rows of the status, whatever has happened before.
class Sizes {
public:
    explicit Sizes(const Topology& topology);
    [[nodiscard]] Problems look(const Statuses& statuses) const;

private:
    struct Rows {
        std::int64_t edges = 0, inputs = 0;
    };

    std::int64_t max_queued_;
    std::map<std::string, Rows> most_;  ///< that a drone can have
};

/// ages: nothing is older than the history, and no time is negative.
/// @param age  of the history, whose drones have one clock
/// @param set  the time of day was: events may have been captured before
Problems impossible_ages(const Statuses& statuses, std::chrono::microseconds age, bool set = false);

}  // namespace hive::mixtures
