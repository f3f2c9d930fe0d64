// A long way between two machines, inside one: what comes at an address goes on to another one after a while, both
// ways.
#pragma once

#include <chrono>
#include <memory>
#include <string>

namespace hive::test {

/// Lives in a network namespace, on a thread of its own, until it is destroyed. Throws std::runtime_error.
class DelayRelay {
public:
    struct Address {
        std::string host;  ///< an IPv4 number
        int port = 0;
    };
    DelayRelay(const std::string& network_namespace, const Address& at, const Address& to,
               std::chrono::milliseconds one_way);
    ~DelayRelay();
    DelayRelay(const DelayRelay&) = delete;
    DelayRelay& operator=(const DelayRelay&) = delete;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace hive::test
