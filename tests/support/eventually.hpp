// Waits for a state instead of a time.
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

namespace hive::test {

using Milliseconds = std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// How much slower everything is under a sanitizer: multiply deadlines by it, and skip measurements.
constexpr bool sanitized()
{
#ifdef HIVE_SANITIZED
    return true;
#else
    return false;
#endif
}

/// A deadline that only guards against hanging: long enough for a slow machine, and longer under a sanitizer.
constexpr Milliseconds patient(Milliseconds time) { return (sanitized() ? 6 : 3) * time; }

/// A bound that is promised to users and measured: extended only under a sanitizer.
constexpr Milliseconds stated(Milliseconds time) { return sanitized() ? 6 * time : time; }

/// Polls every few milliseconds until the condition is true, at most this long; both results may be valid.
template <class Condition>
bool happens_within(Milliseconds time, Condition condition)
{
    for (const auto end = Clock::now() + time; !condition(); std::this_thread::sleep_for(Milliseconds(3)))
        if (Clock::now() >= end)
            return false;
    return true;
}

/// Polls every few milliseconds until the condition is true. False means a hang, not a busy machine: the timeout is at
/// least a minute. Measure promised bounds with stated().
template <class Condition>
bool eventually(Condition condition, Milliseconds timeout = Milliseconds(5000))
{
    return happens_within(std::max(Milliseconds(60'000), patient(timeout)), condition);
}

}  // namespace hive::test
