// How many lines of the log anybody else may cause.
#pragma once

#include <hive/event/clock.hpp>

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace hive::event {

/// Ten lines a second for each peer; what is left out is counted. Any thread.
class LineBudget {
public:
    static constexpr int most_lines = 10;

    /// May a line about this peer be written now? If so, how many were left out before it.
    std::optional<std::int64_t> ask(const std::string& peer, Clock::time_point now);

private:
    struct Second {
        Clock::time_point begun;
        int lines = 0;
        std::int64_t left_out = 0;
    };
    void forget_old(Clock::time_point now);

    std::mutex mutex_;
    std::map<std::string, Second> seconds_;
};

/// " (and 3 lines before it, left out)"; empty for none.
std::string left_out_text(std::int64_t lines);

}  // namespace hive::event
