// Sizes that may not grow without end, and times that no drone can have seen.
#pragma once

#include "checks.hpp"

#include <chrono>

namespace hive::mixtures {

/// bounded: queues, events in hand and rows of the status, whatever has happened before.
class Sizes {
public:
    /// @param guests  receivers that are not in the topology, at most
    /// @param places  addresses of a drone, at most
    explicit Sizes(const Topology& topology, std::int64_t guests = 0, std::int64_t places = 1);
    [[nodiscard]] Problems look(const Statuses& statuses) const;

private:
    struct Rows {
        std::int64_t edges = 0, inputs = 0;
    };

    std::int64_t max_queued_, max_places_;
    std::map<std::string, Rows> most_;  ///< that a drone can have
};

/// ages: nothing is older than the history, and no time is negative.
/// @param age    of the history
/// @param error  of the ages of events at most; empty: the clock was set, and they may have any
Problems impossible_ages(const Statuses& statuses, std::chrono::microseconds age,
                         std::optional<std::chrono::microseconds> error = std::chrono::microseconds(0));

}  // namespace hive::mixtures
