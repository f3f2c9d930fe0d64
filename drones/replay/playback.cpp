// Ranges, repetition and due times.
#include "playback.hpp"

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
}

void Playback::advance(bool again)
{
    current_ = reader_.next();
    if (current_ && range_.to_us > 0 && current_->prefix.time_us >= range_.to_us)
        current_.reset();
    if (!current_ && again)
        rewind();
}

Timeline::Clock::time_point Timeline::due(std::int64_t time_us, double speed, Clock::time_point now)
{
    constexpr auto late = std::chrono::seconds(1);
    const auto at = [&] { return start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::micro>(static_cast<double>(time_us - first_us_) / speed)); };
    if (!begun_ || time_us < last_us_ || speed != speed_ || now - at() > late) {
        begun_ = true;
        first_us_ = time_us;
        speed_ = speed;
        start_ = now;
    }
    last_us_ = time_us;
    return at();
}

}  // namespace replay
