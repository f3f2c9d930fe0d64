// Timers by the clock of the system.
#include <hive/platform/timer.hpp>

#include <asio/steady_timer.hpp>

#include <utility>

namespace hive::platform {

struct Timer::Real {
    asio::steady_timer timer;
};

Timer::Timer(asio::io_context& context) : real_(new Real{asio::steady_timer(context)}) {}
Timer::~Timer() = default;

void Timer::expires_at(SteadyClock::time_point time) { real_->timer.expires_at(time); }
SteadyClock::time_point Timer::expiry() const { return real_->timer.expiry(); }
void Timer::async_wait(Handler handler) { real_->timer.async_wait(std::move(handler)); }
void Timer::cancel() { real_->timer.cancel(); }

}  // namespace hive::platform
