// Limits how often a peer may cause an action, such as a log line or a registration.
#pragma once

#include <hive/event/clock.hpp>

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace hive::event {

/// At most `max` within `time`, for each peer. Any thread.
class RateLimits {
public:
    RateLimits(int max, Clock::duration time) : max_(max), time_(time) {}

    /// If this peer may act once more: the number of suppressed times before that.
    std::optional<std::int64_t> pass(const std::string& peer, Clock::time_point now);

private:
    struct Period {
        Clock::time_point begun;
        int passed = 0;
        std::int64_t kept_back = 0;
    };
    void forget_old(Clock::time_point now);

    const int max_;
    const Clock::duration time_;
    std::mutex mutex_;
    std::map<std::string, Period> periods_;
};

/// " (and 3 lines before it, left out)"; empty for 0.
std::string left_out_text(std::int64_t lines);

}  // namespace hive::event
