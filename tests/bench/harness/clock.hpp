// The one clock of the benchmark: monotonic nanoseconds, the same in every process of the machine.
#pragma once

#include <cerrno>
#include <cstdint>
#include <ctime>

namespace hive::bench {

using Nanoseconds = std::int64_t;

constexpr Nanoseconds millisecond = 1'000'000;
constexpr Nanoseconds second = 1'000'000'000;

inline Nanoseconds now_ns()
{
    timespec time;
    ::clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * second + time.tv_nsec;
}

inline void sleep_until(Nanoseconds when)
{
    const timespec time{when / second, when % second};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
    }
}

inline void sleep_for(Nanoseconds time) { sleep_until(now_ns() + time); }

inline double seconds_of(Nanoseconds time) { return static_cast<double>(time) / static_cast<double>(second); }
inline Nanoseconds nanoseconds_of(double seconds)
{
    return static_cast<Nanoseconds>(seconds * static_cast<double>(second));
}

}  // namespace hive::bench
