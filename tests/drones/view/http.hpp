// A minimal browser: HTTP over a plain socket, so that it can misbehave.
#pragma once

#include <eventually.hpp>

#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>

#include <optional>
#include <string>
#include <vector>

namespace http {

using hive::test::Milliseconds;

struct Reply {
    int code = 0;  ///< 0: none came
    std::string head, body;
    [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(body); }
    [[nodiscard]] cv::Mat image() const;
};

/// A connection to a port of this machine. Every wait has an end.
class Client {
public:
    /// @param receive_bytes  receive buffer; 0: the system's default
    explicit Client(int port, int receive_bytes = 0);
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// False when the other end has closed.
    bool send(const std::string& bytes);
    /// Sends a request with the token of the tests.
    bool ask(const std::string& path);
    /// Reads up to the end of the connection, or to `timeout`.
    Reply reply(Milliseconds timeout = Milliseconds(40'000));
    /// The next image of a stream; nothing when none comes in time.
    std::optional<std::string> next_image(Milliseconds timeout = Milliseconds(40'000));
    /// Does anything more come within the time?
    bool more_within(Milliseconds timeout);
    /// Does the other end close within the time?
    bool closed_within(Milliseconds timeout);

private:
    bool fill(std::chrono::steady_clock::time_point until);
    void unchunk();

    int port_, socket_ = -1;
    bool ended_ = false, in_body_ = false;
    std::string raw_, body_;  ///< received and not processed yet; the body of a stream
};

/// The token of the servers in the tests.
inline const std::string token = "0123456789abcdef";
/// The line of a request with a token, as a browser sends its cookie.
std::string cookie(int port, const std::string& said = token);
/// One request that a browser might send.
Reply get(int port, const std::string& path, const std::string& said = token);
cv::Mat decoded(const std::string& jpeg);

}  // namespace http
