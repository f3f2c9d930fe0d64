// Tells the process's supervisor, such as systemd, that the drone is ready and alive, and what it waits for.
#pragma once

#include <hive/platform/timer.hpp>

#include <string>

namespace hive::service {

/// On the network side, so that long callbacks do not make the supervisor kill the process.
class Supervised {
public:
    /// @param speaks  the process is only this drone
    Supervised(asio::io_context& context, bool speaks) : speaks_(speaks), timer_(context) {}

    void ready();
    void stopping() const { tell("STOPPING=1"); }
    void end();
    /// Any thread. What the drone waits for; empty: for nothing.
    void status(const std::string& text) const;

private:
    void tell(const std::string& news) const;

    const bool speaks_;
    platform::Timer timer_;
    bool ended_ = false;  ///< a cancelled timer may still run once
};

}  // namespace hive::service
