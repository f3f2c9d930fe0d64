// Handles SIGINT and SIGTERM, with which a terminal or a supervisor stops the process.
#pragma once

#include <asio/io_context.hpp>

#include <functional>
#include <memory>

namespace hive::platform {

/// Calls the handler on the first SIGINT or SIGTERM, from the io_context, as long as this object lives.
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
