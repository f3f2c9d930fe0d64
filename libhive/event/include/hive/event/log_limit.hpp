// So many lines in so long: what strangers can make a module write.
#pragma once

#include <hive/event/clock.hpp>

#include <optional>
#include <string>

namespace hive::event {

/// Pure: it is told the time.
class LogLimit {
public:
    LogLimit(int lines, Clock::duration time) : most_(lines), time_(time) {}

    /// The line to be written, which also says how many were kept back before it; nothing when it is one too many.
    std::optional<std::string> pass(const std::string& line, Clock::time_point now);

private:
    const int most_;
    const Clock::duration time_;
    Clock::time_point begin_{};
    int written_ = 0, kept_back_ = 0;
};

}  // namespace hive::event
