// Counting lines.
#include <hive/event/log_limit.hpp>

#include <utility>

namespace hive::event {

std::optional<std::string> LogLimit::pass(const std::string& line, Clock::time_point now)
{
    if (now >= begin_ + time_) {
        begin_ = now;
        written_ = 0;
    }
    if (written_ >= most_) {
        ++kept_back_;
        return std::nullopt;
    }
    ++written_;
    const int kept_back = std::exchange(kept_back_, 0);
    return kept_back == 0 ? line : line + " (and " + std::to_string(kept_back) + " more lines like it)";
}

}  // namespace hive::event
