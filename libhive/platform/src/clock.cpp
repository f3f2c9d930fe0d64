// The clocks of the system.
#include <hive/platform/clock.hpp>

namespace hive::platform {

SteadyClock::time_point SteadyClock::now() noexcept { return std::chrono::steady_clock::now(); }
WallClock::time_point WallClock::now() noexcept { return std::chrono::system_clock::now(); }

}  // namespace hive::platform
