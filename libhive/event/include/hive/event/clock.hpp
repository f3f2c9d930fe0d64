// The clocks of events, as the wire counts them.
#pragma once

#include <hive/platform/clock.hpp>

#include <chrono>
#include <cstdint>

namespace hive::event {

using Clock = platform::SteadyClock;

inline std::int64_t microseconds(std::chrono::nanoseconds duration)
{
    return std::chrono::duration_cast<std::chrono::microseconds>(duration).count();
}
inline std::int64_t wall_us() { return microseconds(platform::WallClock::now().time_since_epoch()); }
inline std::int64_t steady_us() { return microseconds(Clock::now().time_since_epoch()); }

}  // namespace hive::event
