// Selects the sample with the shortest round trip.
#include <hive/event/peer_clock.hpp>

#include <algorithm>

namespace hive::event {
namespace {

using namespace std::chrono_literals;

/// This many, one every 2 s: the offset is right again 16 s after a clock was set.
constexpr std::size_t most_samples = 8, first_samples = 3;

}  // namespace

void PeerClock::answered(Clock::time_point asked, Clock::time_point answered, std::int64_t wall_us,
                         std::int64_t peer_us)
{
    const auto round_trip_us = std::max<std::int64_t>(microseconds(answered - asked), 1);
    samples_.push_back({round_trip_us, peer_us - wall_us - round_trip_us / 2});
    if (samples_.size() > most_samples)
        samples_.pop_front();
    last_ = answered;
}

const PeerClock::Sample* PeerClock::best() const noexcept
{
    const auto found = std::ranges::min_element(samples_, {}, &Sample::round_trip_us);
    return found == samples_.end() ? nullptr : &*found;
}

std::int64_t PeerClock::offset_us() const noexcept { return best() ? best()->offset_us : 0; }
std::int64_t PeerClock::round_trip_us() const noexcept { return best() ? best()->round_trip_us : 0; }

Clock::time_point PeerClock::due() const noexcept { return last_ + (samples_.size() < first_samples ? 50ms : 2000ms); }

}  // namespace hive::event
