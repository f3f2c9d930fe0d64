// A web client for one camera: no redirects, no proxies, checked addresses, limits while reading, and a deadline for
// everything.
#pragma once

#include "address_rule.hpp"
#include "camera_url.hpp"
#include "credentials.hpp"
#include "camera_error.hpp"

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

/// The address of the camera, and the permitted ways to connect.
struct Access {
    CameraUrl url;
    std::optional<Credentials> credentials;
    bool basic_over_http = false;  ///< may the password be sent unencrypted? Otherwise only as a digest, or over https
    std::string certificate;       ///< file of the one certificate to trust for https; empty: those of the system
    AddressRule addresses;
};

/// The head of an answer.
struct Head {
    long status = 0;
    std::string type;                     ///< Content-Type
    std::string location;                 ///< of a redirection
    std::vector<std::string> challenges;  ///< WWW-Authenticate
};

/// Timeouts and limits.
struct Limits {
    std::chrono::milliseconds connecting{2000},
        silence{2000};  ///< until there is a connection; without a byte after that
    std::chrono::milliseconds whole{std::chrono::hours(24 * 365)};
    std::size_t body = 65536;
};

/// Receives the answer. May throw: the transfer ends and fetch() rethrows.
struct Sink {
    std::function<void(const Head&)> head = [](const Head&) {};  ///< of a status 200, before its first byte
    std::function<void(std::string_view)> bytes = [](std::string_view) {};
    std::function<void()> time = [] {};  ///< ten times a second, even without data
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
    /// @throws CameraError  for every status except 200
    void fetch(const std::string& target, const Limits& limits, const Sink& sink);
    /// The complete answer, at most `limits.body` bytes. @param time  as Sink::time
    Reply get(const std::string& target, const Limits& limits, const std::function<void()>& time);

private:
    class Transfer;
    struct Handles;
    Access access_;
    std::unique_ptr<Handles> handles_;
};

}  // namespace axis
