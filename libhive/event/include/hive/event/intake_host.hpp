// What an input's connection needs of its module.
#pragma once

#include <hive/event/link.hpp>
#include <hive/status.hpp>
#include <hive/transport/transport.hpp>

#include <asio/io_context.hpp>

#include <functional>
#include <memory>

namespace hive::event {

class Intake;
class Loop;

/// Network side.
class IntakeHost {
public:
    using OnLink = std::function<void(const LinkPtr&, const Error&)>;

    virtual asio::io_context& context() = 0;
    /// For who may outlive the module.
    [[nodiscard]] virtual std::weak_ptr<Loop> weak_loop() const = 0;
    /// A link to the module at an address: the present one, or a new one. The error counts only without link.
    virtual void with_link(const transport::Address& address, Clock::time_point deadline, OnLink on_link) = 0;
    /// Must inputs wait with asking, and why?
    [[nodiscard]] virtual Reason paused() const = 0;
    /// Do results wait here for their first receiver, which will come?
    [[nodiscard]] virtual bool holds() const = 0;
    /// The epoch of a new registration: later than that of any before it, of whichever input.
    virtual std::int64_t next_registration() = 0;
    /// Something has a deadline now.
    virtual void arm() = 0;
    /// An input that was told to stop has left its sender and is done with all its events.
    virtual void gone(const std::shared_ptr<Intake>& intake) = 0;

protected:
    ~IntakeHost() = default;
};

}  // namespace hive::event
