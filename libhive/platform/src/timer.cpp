// Timers by the clock of the system.
#include <hive/platform/timer.hpp>

#include <asio/steady_timer.hpp>

#include <system_error>
#include <utility>

namespace hive::platform {

struct Timer::Real {
    asio::steady_timer timer;
};

Timer::Timer(asio::io_context& context) : real_(new Real{asio::steady_timer(context)}) {}
Timer::~Timer() = default;

void Timer::run_at(SteadyClock::time_point time, Task task)
{
    real_->timer.expires_at(time);
    real_->timer.async_wait([task = std::move(task)](std::error_code problem) {
        if (!problem)
            task();
    });
}

SteadyClock::time_point Timer::expiry() const { return real_->timer.expiry(); }
void Timer::cancel() { real_->timer.cancel(); }

}  // namespace hive::platform
