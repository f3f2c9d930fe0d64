// hive/platform in the simulated world.
#include "world.hpp"

#include <hive/platform/process.hpp>
#include <hive/platform/signals.hpp>
#include <hive/platform/timer.hpp>

#include <asio/error.hpp>

#include <utility>
#include <vector>

namespace hive::platform {

using simulation::NetworkSide;
using simulation::Operation;
using simulation::world;

SteadyClock::time_point SteadyClock::now() noexcept { return world().now(); }

WallClock::time_point WallClock::now() noexcept
{
    constexpr std::chrono::seconds when_it_began(1'700'000'000);
    return time_point(std::chrono::duration_cast<duration>(when_it_began + world().age()));
}

std::int64_t own_pid() noexcept { return world().current() ? world().current()->pid : 1; }
bool process_ends(std::int64_t pid) { return world().ends(pid); }
void kill_process(std::int64_t pid) { world().kill(pid); }
void sleep_for(std::chrono::nanoseconds time) { world().sleep(time); }
std::uint64_t entropy() { return world().entropy(); }

struct Timer::Real {
    asio::io_context& context;
    SteadyClock::time_point time{};
    std::vector<std::weak_ptr<Operation>> waits{};
};

Timer::Timer(asio::io_context& context) : real_(new Real{context}) {}
Timer::~Timer() { cancel(); }

void Timer::expires_at(SteadyClock::time_point time)
{
    cancel();
    real_->time = time;
}

SteadyClock::time_point Timer::expiry() const { return real_->time; }

void Timer::async_wait(Handler handler)
{
    const std::weak_ptr<Operation> wait =
        NetworkSide::of(real_->context).begin([handler = std::move(handler)](std::error_code problem, std::size_t) {
            handler(problem);
        });
    std::erase_if(real_->waits, [](const auto& each) { return each.expired(); });
    real_->waits.push_back(wait);
    if (real_->time != SteadyClock::time_point::max())
        world().at(real_->time, [wait] {
            if (const auto operation = wait.lock())
                operation->finish({});
        });
}

void Timer::cancel()
{
    for (const auto& wait : std::exchange(real_->waits, {}))
        if (const auto operation = wait.lock())
            operation->finish(asio::error::operation_aborted);
}

/// Nobody sends any: a history kills, or orders a stop.
struct Signals::Real {};
Signals::Signals(asio::io_context&, std::function<void(int)>) {}
Signals::~Signals() = default;

}  // namespace hive::platform
