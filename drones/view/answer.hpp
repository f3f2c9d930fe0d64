// Answers HTTP requests with the page and its parts, or says why not. Knows nothing of sockets or files.
#pragma once

#include "exchange.hpp"
#include "host.hpp"
#include "pass.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace view {

struct Request {
    std::string_view method, path;
    std::optional<std::string_view> host;  ///< the header Host
    std::string_view token = {};           ///< in the address: ?token=
    std::string_view cookie = {};          ///< the one of Pass::cookie_name()
    std::string_view site = {};            ///< the header Sec-Fetch-Site
};

/// How many look, and how many may.
struct Browsers {
    std::size_t now = 0, most = 0;
};

struct Answer {
    unsigned code = 200;
    std::string type;  ///< media type
    std::string body;
    enum { text, picture, stream } what = text;  ///< a picture or a Stream takes the place of the body
    bool plain = false;                          ///< of pictures without captions
    std::string cookie = {};                     ///< to be set; the browser then goes on to "/"
};

Answer answer_to(const Request& request, const Exchange& exchange, const Address& bind, const Pass& pass,
                 Browsers browsers);
/// Who waited too long for a picture gets this instead.
Answer not_ready();

}  // namespace view
