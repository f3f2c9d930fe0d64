// A long way between two machines, inside one: what comes at an address goes on to another one after a while, both
// ways.
#pragma once

#include "network_space.hpp"

#include <chrono>
#include <memory>
#include <string>

namespace hive::test {

/// Lives in a network namespace, on a thread of its own, until it is destroyed. Throws std::runtime_error.
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
