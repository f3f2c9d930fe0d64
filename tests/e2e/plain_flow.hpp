// Measures the network itself: a plain TCP connection that sends at full speed.
#pragma once

#include "network_space.hpp"

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

namespace hive::test {

/// From one network namespace to an address of another one, with the operating system's own settings, until it is
/// destroyed. Throws std::runtime_error.
class PlainFlow {
public:
    PlainFlow(const std::string& from_network, const std::string& to_network, const NetworkAddress& to);
    ~PlainFlow();
    PlainFlow(const PlainFlow&) = delete;
    PlainFlow& operator=(const PlainFlow&) = delete;

    [[nodiscard]] std::int64_t received_bytes() const { return received_; }
    /// Bytes in the sender's kernel: not sent or not acknowledged.
    [[nodiscard]] int held_bytes() const;

private:
    void send();
    void receive();

    int sending_ = -1, receiving_ = -1;
    std::atomic<std::int64_t> received_ = 0;
    std::thread sender_, receiver_;
};

}  // namespace hive::test
