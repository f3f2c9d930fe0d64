#include <hive/event/rate_limits.hpp>

#include <utility>

namespace hive::event {

std::optional<std::int64_t> RateLimits::pass(const std::string& peer, Clock::time_point now)
{
    constexpr std::size_t max_peers = 1024;
    const std::lock_guard lock(mutex_);
    if (periods_.size() >= max_peers && !periods_.contains(peer))
        forget_old(now);
    auto& period = periods_[peer];
    if (now - period.begun >= time_)
        period = {now, 0, period.kept_back};
    if (++period.passed <= max_)
        return std::exchange(period.kept_back, 0);
    ++period.kept_back;
    return std::nullopt;
}

/// Forgets expired periods; all if none has expired.
void RateLimits::forget_old(Clock::time_point now)
{
    if (std::erase_if(periods_, [&](const auto& row) { return now - row.second.begun >= time_; }) == 0)
        periods_.clear();
}

std::string left_out_text(std::int64_t lines)
{
    if (lines == 0)
        return "";
    return " (and " + std::to_string(lines) + (lines == 1 ? " line" : " lines") + " before it, left out)";
}

}  // namespace hive::event
