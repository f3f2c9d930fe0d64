// hive/platform in the simulated world.
#include "world.hpp"

#include <hive/platform/files.hpp>
#include <hive/platform/process.hpp>
#include <hive/platform/signals.hpp>
#include <hive/platform/supervisor.hpp>
#include <hive/platform/timer.hpp>
#include <hive/platform/usage.hpp>

#include <asio/error.hpp>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sys/file.h>
#include <utility>
#include <vector>

namespace hive::platform {

using simulation::NetworkSide;
using simulation::Operation;
using simulation::world;

SteadyClock::time_point SteadyClock::now() noexcept { return world().now(); }

WallClock::time_point WallClock::now() noexcept
{
    const auto* const process = world().current();
    const auto time = world().wall_clock(process ? process->machine : 0);
    return time_point(std::chrono::duration_cast<duration>(simulation::when_it_began + time));
}

std::int64_t own_pid() noexcept { return world().current() ? world().current()->pid : 1; }
bool process_ends(std::int64_t pid) { return world().ends(pid); }
void kill_process(std::int64_t pid) { world().kill(pid); }
std::size_t most_descriptors() { return 1024; }
std::uint64_t entropy() { return world().entropy(); }
ProcessUsage process_usage() { return {}; }
MachineUsage machine_usage() { return {}; }
void tell_supervisor(const std::string&) noexcept {}
std::optional<std::chrono::microseconds> supervisor_timeout() { return std::nullopt; }

bool write_private(const std::filesystem::path& file, const std::string& text)
{
    if (world().current() && !world().may_write(*world().current()))
        return true;
    return !std::ofstream(file, std::ios::trunc).write(text.data(), std::ssize(text)).flush().fail();
}

std::error_code rename(const std::filesystem::path& from, const std::filesystem::path& to)
{
    std::error_code problem;
    if (!world().current() || world().may_write(*world().current()))
        std::filesystem::rename(from, to, problem);
    return problem;
}

/// No process is interrupted while it holds one.
std::error_code lock(int descriptor, std::chrono::nanoseconds)
{
    return {::flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno, std::generic_category()};
}

struct Timer::Real {
    asio::io_context& context;
    SteadyClock::time_point time{};
    std::weak_ptr<Operation> wait{};
};

Timer::Timer(asio::io_context& context) : real_(new Real{context}) {}
Timer::~Timer() { cancel(); }

SteadyClock::time_point Timer::expiry() const { return real_->time; }

void Timer::run_at(SteadyClock::time_point time, Task task)
{
    cancel();
    real_->time = time;
    real_->wait = NetworkSide::of(real_->context).begin([task = std::move(task)](std::error_code problem, std::size_t) {
        if (!problem)
            task();
    });
    if (time != SteadyClock::time_point::max())
        world().at(time, [wait = real_->wait] {
            if (const auto operation = wait.lock())
                operation->finish({});
        });
}

void Timer::cancel()
{
    if (const auto operation = std::exchange(real_->wait, {}).lock())
        operation->finish(asio::error::operation_aborted);
}

/// There are no signals: a history kills, or orders a stop.
struct Signals::Real {};
Signals::Signals(asio::io_context&, std::function<void(int)>) {}
Signals::~Signals() = default;

}  // namespace hive::platform
