// A web client for one camera: no redirects, no proxies, checked addresses, limits while reading, and a deadline for
// everything.
#pragma once

#include "address_rule.hpp"
#include "camera_url.hpp"
#include "credentials.hpp"
#include "trouble.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace axis {

/// Where the camera is and how it may be talked to.
struct Access {
    CameraUrl url;
    std::optional<Credentials> credentials;
    bool basic_over_http = false;  ///< may the password travel readable? Otherwise only as a digest, or inside https
    std::string certificate;       ///< file of the one certificate to trust for https; empty: those of the system
    AddressRule addresses;
};

/// The beginning of an answer.
struct Head {
    long status = 0;
    std::string type;                     ///< Content-Type
    std::string location;                 ///< of a redirection
    std::vector<std::string> challenges;  ///< WWW-Authenticate
};

/// How long to wait, and how much to take.
struct Patience {
    std::chrono::milliseconds connecting{2000},
        silence{2000};  ///< until there is a connection; without a byte after that
    std::chrono::milliseconds whole{std::chrono::hours(24 * 365)};
    std::size_t body = 65536;
};

/// Is told what comes. May throw: the transfer ends and fetch() throws it on.
struct Sink {
    std::function<void(const Head&)> head = [](const Head&) {};  ///< of a status 200, before its first byte
    std::function<void(std::string_view)> bytes = [](std::string_view) {};
    std::function<void()> time = [] {};  ///< ten times a second, also when nothing comes
};

struct Reply {
    std::string type, body;
};

/// For one thread at a time. Keeps its connection for the next request, if the camera does.
class Http {
public:
    explicit Http(Access access);
    ~Http();
    Http(const Http&) = delete;
    Http& operator=(const Http&) = delete;

    /// @param target  path and query, written by this program
    /// @throws CameraError  for everything but a status 200
    void fetch(const std::string& target, const Patience& patience, const Sink& sink);
    /// The whole answer, at most `patience.body` bytes. @param time  as Sink::time
    Reply get(const std::string& target, const Patience& patience, const std::function<void()>& time);

private:
    class Transfer;
    struct Handles;
    Access access_;
    std::unique_ptr<Handles> handles_;
};

}  // namespace axis
