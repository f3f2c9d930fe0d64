// The common part of all dialers: one answer, at the latest at the deadline.
#pragma once

#include <hive/platform/timer.hpp>
#include <hive/transport/transport.hpp>

namespace hive::transport {

/// Kept alive by its deadline until it is answered. On the network side.
class DialAttempt : public std::enable_shared_from_this<DialAttempt> {
public:
    DialAttempt(asio::io_context& context, const Address& address, OnDialed on_dialed, const Timing& timing);
    virtual ~DialAttempt() = default;
    void start(std::chrono::milliseconds deadline);

protected:
    /// Starts; may throw hive::Error, which becomes the answer.
    virtual void begin() = 0;
    /// The answer was given: stops pending work.
    virtual void cancel() noexcept = 0;

    void succeed(std::unique_ptr<Stream> stream);
    void fail(Errc code, const std::string& why, const std::string& advice = {});
    [[nodiscard]] bool answered() const { return !on_dialed_; }

    asio::io_context& context_;
    const Address address_;

private:
    void answer(Result<std::shared_ptr<Connection>> result);

    OnDialed on_dialed_;
    const Timing timing_;
    platform::Timer deadline_;
};

}  // namespace hive::transport
