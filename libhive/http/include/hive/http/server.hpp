// The HTTP server that view and hivectl share. Its site makes the answers; no file is served.
#pragma once

#include <hive/http/answer.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace hive::http {

/// One complete request that has not been answered.
struct Visit {
    const Address& bind;
    const Pass& pass;
    std::size_t streams = 0;  ///< being read
    Clock::time_point now{};
    bool again = false;   ///< Site::answer was called for it before, without an answer
    bool late = false;    ///< this call must answer it
    std::uint64_t& mark;  ///< for the site: 0 at first, then the value that the site left
};

/// Makes the answers of one server.
class Site {
public:
    Site();
    virtual ~Site();
    Site(const Site&) = delete;
    Site& operator=(const Site&) = delete;

    /// On the thread of the server, so other clients wait as long as this takes. Nothing: called again after wake() and
    /// from time to time, until the visit is late.
    virtual std::optional<Answer> answer(const Request& request, Visit& visit) = 0;
    /// Maximum bytes of a request's body; a longer one gets 413. 0: no body is read, the request is answered once its
    /// head has arrived. On the thread of the server.
    virtual std::size_t takes(const Request&, const Visit&) { return 0; }
    /// Signals news for waiting visits and streams. From any thread.
    void wake() noexcept;

private:
    friend class Server;
    const int wakes_;  ///< an eventfd, so that wake() works with and without a server
};

/// One thread serves all clients and never waits for one of them. Requests are small; each connection is one request.
/// Connections without a complete request take no capacity from those with one.
class Server {
public:
    struct Settings {
        std::string bind = "127.0.0.1";
        int port = 0;                                 ///< 0: any free port
        std::string token = {};                       ///< that clients must send; empty: every client is refused
        std::string cookie = {};                      ///< name of the cookie, before "-PORT"; empty: no cookie
        const char* allow = "GET";                    ///< the header Allow
        std::size_t connections = 32;                 ///< at once; more are answered 503
        std::size_t strangers = 16;                   ///< without a complete request; one more evicts the oldest
        std::size_t streams = 8;                      ///< at once; the site refuses more
        std::chrono::milliseconds asking{5000};       ///< until the request is complete
        std::chrono::milliseconds preparing{20'000};  ///< until the site has an answer; then the visit is late
        std::chrono::milliseconds answering{30'000};  ///< until the answer is read, except a stream
        std::chrono::seconds stalled{10};             ///< without a byte read
        std::chrono::milliseconds repeat{2000};       ///< a stream sends at this interval, to detect closed readers
    };

    /// Listens when it returns. Throws std::runtime_error with the reason if it cannot.
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
