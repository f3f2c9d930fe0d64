// A timer of an io_context, by the clock of the platform. Chosen at link time, as that is.
#pragma once

#include <hive/platform/clock.hpp>

#include <asio/io_context.hpp>

#include <functional>
#include <memory>
#include <system_error>

namespace hive::platform {

/// As asio::steady_timer: setting the time, cancelling or destroying it calls who waits with operation_aborted, from
/// the io_context.
class Timer {
public:
    using Handler = std::function<void(std::error_code)>;

    explicit Timer(asio::io_context& context);
    Timer(asio::io_context& context, SteadyClock::time_point time) : Timer(context) { expires_at(time); }
    ~Timer();
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

    void expires_at(SteadyClock::time_point time);
    void expires_after(SteadyClock::duration time) { expires_at(SteadyClock::now() + time); }
    [[nodiscard]] SteadyClock::time_point expiry() const;
    void async_wait(Handler handler);
    void cancel();

private:
    struct Real;
    std::unique_ptr<Real> real_;
};

}  // namespace hive::platform
