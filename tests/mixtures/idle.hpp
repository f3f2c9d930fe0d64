// What waits for a group goes to a member that has nothing to do.
#pragma once

#include "checks.hpp"

#include <chrono>

namespace hive::mixtures {

/// idle: no event of a group waits for long while a member has asked and nothing is left at it or behind it. Time
/// counts only between looks that follow one another.
class Idle {
public:
    using Time = std::chrono::steady_clock::time_point;

    explicit Idle(std::chrono::milliseconds limit) : limit_(limit) {}

    Problems look(const Statuses& statuses, Time now);

private:
    std::chrono::milliseconds limit_;
    std::map<std::string, Time> since_;  ///< when a registration was seen to be idle while something waited
    Time looked_{};
};

}  // namespace hive::mixtures
