// Waiting for a state instead of for a time.
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

namespace hive::test {

using Milliseconds = std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// How much slower everything is under a sanitizer: multiply deadlines, skip what measures.
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

/// A bound that is promised to users, and is measured: not stretched, but for a sanitizer.
constexpr Milliseconds stated(Milliseconds time) { return sanitized() ? 6 * time : time; }

/// Asks every few milliseconds until the condition is true, for at most this long; either answer may be right.
template <class Condition>
bool happens_within(Milliseconds time, Condition condition)
{
    for (const auto end = Clock::now() + time; !condition(); std::this_thread::sleep_for(Milliseconds(3)))
        if (Clock::now() >= end)
            return false;
    return true;
}

/// Asks every few milliseconds until the condition is true. A false answer means that it hangs, not that the machine is
/// busy: it takes a minute at least. A bound that is a promise is measured with stated().
template <class Condition>
bool eventually(Condition condition, Milliseconds patience = Milliseconds(5000))
{
    return happens_within(std::max(Milliseconds(60'000), patient(patience)), condition);
}

}  // namespace hive::test
