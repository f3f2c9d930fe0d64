// The HTTP server: it serves one page with its style and script, one picture, one stream and one status, and nothing
// from files.
#pragma once

#include "exchange.hpp"

#include <chrono>
#include <memory>
#include <string>

namespace view {

/// One thread serves all browsers and never waits for one of them; another one prepares the pictures that they ask for.
/// Only GET; a request is small, soon complete, and says a Host of ours and the token; each connection is one request.
/// Connections without the token take no capacity from those with it.
class Server {
public:
    struct Settings {
        std::string bind = "127.0.0.1";
        int port = 0;                                 ///< 0: any that is free
        std::string token = {};                       ///< what browsers must know; empty: nobody may look
        std::size_t connections = 32;                 ///< at once; more are answered 503
        std::size_t strangers = 16;                   ///< that have not asked yet; one more, and the oldest is closed
        std::size_t streams = 8;                      ///< at once; more are answered 503
        std::chrono::milliseconds asking{5000};       ///< until the request is complete
        std::chrono::milliseconds preparing{20'000};  ///< until the picture that was asked for is; then 503
        std::chrono::milliseconds answering{30'000};  ///< until the answer is read, but that of a stream
        std::chrono::seconds stalled{10};             ///< without a byte read
        std::chrono::milliseconds repeat{2000};       ///< of the last picture, when there is no newer one
    };

    /// Listens when it returns. Throws std::runtime_error saying why it cannot.
    /// @param exchange  outlives the server
    Server(const Settings& settings, const Exchange& exchange);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] int port() const noexcept;
    /// There is a new picture. From any thread.
    void wake() noexcept;

private:
    class Core;
    std::unique_ptr<Core> core_;
};

}  // namespace view
