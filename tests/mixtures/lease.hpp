// Members of a group keep what they work on, for as long as their lease.
#pragma once

#include "checks.hpp"

#include <chrono>

namespace hive::mixtures {

/// lease: nothing is taken from a member that goes on working, is connected, and hands nothing back. What it still has
/// from an earlier registration it works on first, so that has to be gone.
class Lease {
public:
    using Time = std::chrono::steady_clock::time_point;

    Problems look(const Statuses& statuses, Time now);

private:
    /// No lease of a round is shorter than twice that.
    static constexpr auto short_time = std::chrono::milliseconds(400);

    struct Row {
        std::int64_t registration = 0, worked = 0, handed_back = 0, passed_on = 0;
        bool emptied = false;  ///< had nothing in hand since it registered or handed something back
        Time progressed{};     ///< not before that it has finished an event
    };
    bool broken(const std::string& key, Row now);

    std::map<std::string, Row> before_, rows_;  ///< of both ends that could be asked at the last look, and at this one
    Time looked_{};
};

/// lease: what a member has and does not finish goes to the others when its lease is over. Time counts only between
/// looks that follow one another.
class Overdue {
public:
    using Time = std::chrono::steady_clock::time_point;

    Problems look(const Statuses& statuses, Time now);

private:
    struct Row {
        std::int64_t finished = 0;
        Time since{};                                        ///< it has finished nothing
        std::optional<std::int64_t> passed_on_when_empty{};  ///< of that registration; empty: never seen to be
    };
    Row& row(const std::string& registration, std::int64_t finished, Time now, bool followed);

    std::map<std::string, Row> before_, rows_;  ///< by registration
    Time looked_{};
};

}  // namespace hive::mixtures
