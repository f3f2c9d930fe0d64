// Requests to an HTTP server and its answers, without sockets or files.
#pragma once

#include <hive/http/host.hpp>
#include <hive/http/pass.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hive::http {

using Clock = std::chrono::steady_clock;
using Bytes = std::shared_ptr<const std::vector<unsigned char>>;

struct Request {
    std::string_view method, path;
    std::optional<std::string_view> host;  ///< the header Host
    std::string_view token = {};           ///< in the address: ?token=
    std::string_view cookie = {};          ///< the value of the cookie Pass::cookie_name()
    std::string_view site = {};            ///< the header Sec-Fetch-Site
    std::string_view authorization = {};   ///< the header of that name
    std::string_view accept = {};          ///< the header of that name
    std::string_view origin = {};          ///< the header Origin: the page that sends the request
    std::string_view content_type = {};    ///< the header of that name
    std::string_view body = {};            ///< only if the site accepts one, see Site::takes()
};

/// An endless body, for one reader.
class EndlessBody {
public:
    virtual ~EndlessBody() = default;
    /// Copies the next bytes; returns their number. 0: nothing to send yet.
    virtual std::size_t read(std::span<char> to, Clock::time_point now) = 0;
};

struct Answer {
    unsigned code = 200;
    std::string type{};  ///< media type
    std::string body{};
    std::string cookie{};                   ///< to be set; the browser is then redirected to "/"
    std::string tag{};                      ///< the header ETag; empty: none
    Bytes bytes{};                          ///< if not null, instead of the body
    std::shared_ptr<EndlessBody> stream{};  ///< if not null, instead of both
};

/// A text for people.
Answer sentence(unsigned code, std::string text);

/// Refuses a request to a foreign host name, from another page, without the token, or with another method than GET.
/// Nothing if the request is allowed. A refusal reveals nothing about the site.
/// @param hint  a sentence for a client without the token
std::optional<Answer> refusal(const Request& request, const Address& bind, const Pass& pass, const char* hint);
/// The same for a site that also accepts commands: POST is allowed too, from its own pages only. Such a request has the
/// cookie, the site itself as Origin, and a JSON body, which no form of another page can send.
std::optional<Answer> refusal_of_command(const Request& request, const Address& bind, const Pass& pass,
                                         const char* hint);

}  // namespace hive::http
