// What an HTTP server is asked and answers. Knows nothing of sockets or files.
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
    std::string_view cookie = {};          ///< the one of Pass::cookie_name()
    std::string_view site = {};            ///< the header Sec-Fetch-Site
    std::string_view authorization = {};   ///< the header of that name
    std::string_view accept = {};          ///< the header of that name
    std::string_view origin = {};          ///< the header of that name: which page asks
    std::string_view content_type = {};    ///< the header of that name
    std::string_view body = {};            ///< only if the site takes one, see Site::takes()
};

/// A body without end, for one reader.
class EndlessBody {
public:
    virtual ~EndlessBody() = default;
    /// Copies the next bytes; returns how many. 0: nothing to send at this time.
    virtual std::size_t read(std::span<char> to, Clock::time_point now) = 0;
};

struct Answer {
    unsigned code = 200;
    std::string type{};  ///< media type
    std::string body{};
    std::string cookie{};                   ///< to be set; the browser then goes on to "/"
    std::string tag{};                      ///< the header ETag; empty: none
    Bytes bytes{};                          ///< if not null, instead of the body
    std::shared_ptr<EndlessBody> stream{};  ///< if not null, instead of both
};

/// A text for people.
Answer sentence(unsigned code, std::string text);

/// Why a page is not shown: to a foreign host name, to other pages, without the token, with another method than GET.
/// Nothing if it is. Who may not look learns nothing.
/// @param hint  a sentence for a client without the token
std::optional<Answer> refusal(const Request& request, const Address& bind, const Pass& pass, const char* hint);
/// The same of a site that can also be told to do something: POST is allowed too, to its own pages alone. Such a
/// request brings the cookie, an Origin that is the site itself, and JSON: no form of another page can send that.
std::optional<Answer> refusal_of_command(const Request& request, const Address& bind, const Pass& pass,
                                         const char* hint);

}  // namespace hive::http
