// The two clocks of the library. Chosen at link time: the system's clocks, or those of a simulation.
#pragma once

#include <chrono>

namespace hive::platform {

/// Never goes back; counts from the start of the machine.
struct SteadyClock {
    using duration = std::chrono::steady_clock::duration;
    using rep = duration::rep;
    using period = duration::period;
    using time_point = std::chrono::steady_clock::time_point;
    static constexpr bool is_steady = true;
    [[nodiscard]] static time_point now() noexcept;
};

/// The time of day; may be set.
struct WallClock {
    using duration = std::chrono::system_clock::duration;
    using rep = duration::rep;
    using period = duration::period;
    using time_point = std::chrono::system_clock::time_point;
    static constexpr bool is_steady = false;
    [[nodiscard]] static time_point now() noexcept;
};

}  // namespace hive::platform
