#include <hive/event/line_budget.hpp>

namespace hive::event {
namespace {

constexpr auto window = std::chrono::seconds(1);
constexpr std::size_t max_rows = 1024;

}  // namespace

std::optional<std::int64_t> LineBudget::ask(LogLevel level, const std::string& peer, Clock::time_point now)
{
    const std::lock_guard lock(mutex_);
    const std::pair row(level, peer);
    if (seconds_.size() >= max_rows && !seconds_.contains(row))
        forget_old(now);
    auto& second = seconds_[row];
    if (now - second.begun >= window)
        second = {now, 0, second.left_out};
    if (++second.lines <= most_lines)
        return std::exchange(second.left_out, 0);
    ++second.left_out;
    return std::nullopt;
}

/// Those whose second is over; all of them if none is.
void LineBudget::forget_old(Clock::time_point now)
{
    std::erase_if(seconds_, [&](const auto& row) { return now - row.second.begun >= window; });
    if (seconds_.size() >= max_rows)
        seconds_.clear();
}

std::string left_out_text(std::int64_t lines)
{
    if (lines == 0)
        return "";
    return " (and " + std::to_string(lines) + (lines == 1 ? " line" : " lines") + " before it, left out)";
}

}  // namespace hive::event
