// Answers HTTP requests with the page and its parts, or says why not. Knows nothing of sockets or files.
#pragma once

#include "exchange.hpp"
#include "host.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace view {

struct Request {
    std::string_view method, path;
    std::optional<std::string_view> host;  ///< the header Host
};

/// How many look, and how many may.
struct Browsers {
    std::size_t now = 0, most = 0;
};

struct Answer {
    unsigned code = 200;
    std::string type;  ///< media type
    std::string body;
    bool stream = false;  ///< the body is a Stream instead
    bool plain = false;   ///< of pictures without captions
};

Answer answer_to(const Request& request, const Exchange& exchange, const Address& bind, Browsers browsers);

}  // namespace view
