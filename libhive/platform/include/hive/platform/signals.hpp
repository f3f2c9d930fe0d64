// The wish of a terminal or a supervisor that the process ends.
#pragma once

#include <asio/io_context.hpp>

#include <functional>
#include <memory>

namespace hive::platform {

/// Calls the handler with the first SIGINT or SIGTERM, from the io_context, until it is destroyed.
class Signals {
public:
    Signals(asio::io_context& context, std::function<void(int)> handler);
    ~Signals();
    Signals(const Signals&) = delete;
    Signals& operator=(const Signals&) = delete;

private:
    struct Real;
    std::unique_ptr<Real> real_;
};

}  // namespace hive::platform
