// The server of the page: one page with its style and script, one image, one stream and one status.
#pragma once

#include "exchange.hpp"

#include <hive/http/server.hpp>

#include <memory>

namespace view {

/// One thread serves all browsers and never waits for one of them; another one prepares the requested images.
class Server {
public:
    using Settings = hive::http::Server::Settings;

    /// Listens when it returns. Throws std::runtime_error with the reason if it cannot.
    /// @param exchange  outlives the server
    Server(Settings settings, const Exchange& exchange);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] int port() const noexcept;
    /// Signals a new image. From any thread.
    void wake() noexcept;

private:
    class Core;
    std::unique_ptr<Core> core_;
};

}  // namespace view
