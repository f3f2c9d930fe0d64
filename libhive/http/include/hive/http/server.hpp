// The HTTP server that view and hivectl share: what it answers is its site's matter, and nothing comes from files.
#pragma once

#include <hive/http/answer.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace hive::http {

/// One request, from when it was complete until it is answered.
struct Visit {
    const Address& bind;
    const Pass& pass;
    std::size_t streams = 0;  ///< that are being read
    Clock::time_point now{};
    bool again = false;   ///< it was asked before, and had no answer yet
    bool late = false;    ///< it has to be answered at this call
    std::uint64_t& mark;  ///< for the site: 0 at first, and then what it was set to
};

/// What one server answers.
class Site {
public:
    Site();
    virtual ~Site();
    Site(const Site&) = delete;
    Site& operator=(const Site&) = delete;

    /// On the thread of the server: other clients wait as long as this takes. Nothing: asked again after wake(), and
    /// from time to time, until the visit is late.
    virtual std::optional<Answer> answer(const Request& request, Visit& visit) = 0;
    /// How many bytes of a body are read before the request is answered. A longer one gets 413. 0: it is answered when
    /// its head is there, and no body is read. On the thread of the server.
    virtual std::size_t takes(const Request&, const Visit&) { return 0; }
    /// There is something new for visits that wait, and for streams. From any thread.
    void wake() noexcept;

private:
    friend class Server;
    const int wakes_;  ///< an eventfd, so that the site can be woken whether it has a server or not
};

/// One thread serves all clients and never waits for one of them. A request is small and soon complete; each connection
/// is one request. Connections that have not asked take no capacity from those that have.
class Server {
public:
    struct Settings {
        std::string bind = "127.0.0.1";
        int port = 0;                                 ///< 0: any that is free
        std::string token = {};                       ///< what clients must know; empty: none is right
        std::string cookie = {};                      ///< the cookie is called so, with "-PORT"; empty: there is none
        const char* allow = "GET";                    ///< the header Allow
        std::size_t connections = 32;                 ///< at once; more are answered 503
        std::size_t strangers = 16;                   ///< that have not asked yet; one more, and the oldest is closed
        std::size_t streams = 8;                      ///< at once; the site refuses more
        std::chrono::milliseconds asking{5000};       ///< until the request is complete
        std::chrono::milliseconds preparing{20'000};  ///< until the site has an answer; then the visit is late
        std::chrono::milliseconds answering{30'000};  ///< until the answer is read, but that of a stream
        std::chrono::seconds stalled{10};             ///< without a byte read
        std::chrono::milliseconds repeat{2000};  ///< a stream sends something so often, to notice readers that are gone
    };

    /// Listens when it returns. Throws std::runtime_error saying why it cannot.
    /// @param site  outlives the server
    Server(const Settings& settings, Site& site);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] int port() const noexcept;

private:
    class Core;
    std::unique_ptr<Core> core_;
};

}  // namespace hive::http
