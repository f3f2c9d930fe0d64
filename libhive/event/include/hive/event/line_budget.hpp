// Limits the log lines that peers cause.
#pragma once

#include <hive/event/clock.hpp>
#include <hive/log_level.hpp>

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace hive::event {

/// At most ten lines per second, peer and level, so that no line keeps back one of another level; counts the rest. Any
/// thread.
class LineBudget {
public:
    static constexpr int most_lines = 10;

    /// If a line of this level about this peer may be written now: how many were left out before it.
    std::optional<std::int64_t> ask(LogLevel level, const std::string& peer, Clock::time_point now);

private:
    struct Second {
        Clock::time_point begun;
        int lines = 0;
        std::int64_t left_out = 0;
    };
    void forget_old(Clock::time_point now);

    std::mutex mutex_;
    std::map<std::pair<LogLevel, std::string>, Second> seconds_;
};

/// " (and 3 lines before it, left out)"; empty for none.
std::string left_out_text(std::int64_t lines);

}  // namespace hive::event
