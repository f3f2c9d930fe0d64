// Simulates a long path: forwards data from one address to another with a delay, in both directions.
#pragma once

#include "network_space.hpp"

#include <chrono>
#include <memory>
#include <string>

namespace hive::test {

/// Runs in a network namespace, on its own thread, until it is destroyed. Throws std::runtime_error.
class DelayRelay {
public:
    DelayRelay(const std::string& network_namespace, const NetworkAddress& at, const NetworkAddress& to,
               std::chrono::milliseconds one_way);
    ~DelayRelay();
    DelayRelay(const DelayRelay&) = delete;
    DelayRelay& operator=(const DelayRelay&) = delete;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace hive::test
