// Runs a task of an io_context at a time of the platform's clock. Chosen at link time, as that clock is.
#pragma once

#include <hive/platform/clock.hpp>

#include <asio/io_context.hpp>

#include <functional>
#include <memory>
#include <utility>

namespace hive::platform {

/// Has at most one task. A new task, cancel() and the destructor drop it; a task that is due at that moment may still
/// run.
class Timer {
public:
    using Task = std::function<void()>;

    explicit Timer(asio::io_context& context);
    ~Timer();
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

    void run_at(SteadyClock::time_point time, Task task);
    void run_after(SteadyClock::duration time, Task task) { run_at(SteadyClock::now() + time, std::move(task)); }
    /// The time of the last task.
    [[nodiscard]] SteadyClock::time_point expiry() const;
    void cancel();

private:
    struct Real;
    std::unique_ptr<Real> real_;
};

}  // namespace hive::platform
