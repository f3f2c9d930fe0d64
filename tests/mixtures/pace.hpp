// A source on demand produces as soon as all have asked.
#pragma once

#include "checks.hpp"

#include <chrono>

namespace hive::mixtures {

/// pace: a source on demand that has something to produce, and neither it nor its output says why not, does so within
/// `limit`. Time counts only between looks that follow one another: nobody knows what was asked in a longer gap.
class Pace {
public:
    using Time = std::chrono::steady_clock::time_point;

    explicit Pace(std::chrono::milliseconds limit) : limit_(limit) {}

    /// @param fed  how many events the source may make
    Problems look(const Statuses& statuses, std::int64_t fed, Time now);

private:
    struct Due {
        std::int64_t epoch = 0, produced = 0;
        bool operator==(const Due&) const = default;
    };
    std::chrono::milliseconds limit_;
    std::optional<Due> due_;  ///< what could have been produced at the last look
    Time since_{}, looked_{};
};

}  // namespace hive::mixtures
