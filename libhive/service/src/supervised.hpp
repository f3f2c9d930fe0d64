// Tells whoever supervises the process, as systemd does, that the drone is ready, that it lives, and what it waits for.
#pragma once

#include <hive/platform/timer.hpp>

#include <string>

namespace hive::service {

/// On the network side, so that user code that takes long is no reason to end the process.
class Supervised {
public:
    explicit Supervised(asio::io_context& context) : timer_(context) {}

    void ready();
    void stopping();
    void end() { timer_.cancel(); }
    /// Any thread. What the drone waits for; empty: for nothing.
    static void status(const std::string& text);

private:
    void alive();

    platform::Timer timer_;
};

}  // namespace hive::service
