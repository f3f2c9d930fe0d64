// Applies the range, repeats it, and computes due times.
#include "playback.hpp"

#include <algorithm>
#include <utility>

namespace replay {

Playback::Playback(const std::filesystem::path& path, const Range& range) : reader_(path), range_(range) { rewind(); }

void Playback::rewind()
{
    reader_.seek(range_.from_us);
    do
        current_ = reader_.next();
    while (current_ && current_->prefix.time_us < range_.from_us);
    if (current_ && range_.to_us > 0 && current_->prefix.time_us >= range_.to_us)
        current_.reset();
    first_us_ = last_us_ = current_ ? current_->prefix.time_us : 0;
    distances_ = 0;
}

std::int64_t Playback::advance(bool again)
{
    current_ = reader_.next();
    if (current_ && range_.to_us > 0 && current_->prefix.time_us >= range_.to_us)
        current_.reset();
    if (current_) {
        last_us_ = current_->prefix.time_us;
        ++distances_;
        return 0;
    }
    if (!again)
        return 0;
    const auto pause = pause_us();
    rewind();
    ++rounds_;
    return pause;
}

/// The mean interval of the events; longer if a round would be so short that the loop would spin.
std::int64_t Playback::pause_us() const
{
    constexpr std::int64_t shortest_round_us = 100'000;
    const auto length = std::max<std::int64_t>(last_us_ - first_us_, 0);
    const auto mean = distances_ > 0 ? length / distances_ : 0;
    return std::max(mean, shortest_round_us - length);
}

Timeline::Clock::time_point Timeline::due(std::int64_t time_us, double speed, Clock::time_point now)
{
    constexpr auto late = std::chrono::seconds(1);
    constexpr double longest_us = 1e15;  // thirty years, which a clock can still add
    const auto took = [&](std::int64_t us) {
        return std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double, std::micro>(std::min(static_cast<double>(us) / speed, longest_us)));
    };
    const auto at = [&] { return start_ + took(time_us - first_us_); };
    if (!started_ || time_us < last_us_ || speed != speed_ || now - at() > late) {
        started_ = true;
        first_us_ = time_us;
        speed_ = speed;
        start_ = now + took(std::exchange(pause_us_, 0));
    }
    last_us_ = time_us;
    return at();
}

void Timeline::restart(std::int64_t pause_us)
{
    started_ = false;
    pause_us_ = pause_us;
}

}  // namespace replay
