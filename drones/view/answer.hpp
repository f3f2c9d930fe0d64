// Answers HTTP requests with the page and its parts, or with the reason for a refusal. Uses no sockets or files.
#pragma once

#include "exchange.hpp"

#include <hive/http/answer.hpp>

namespace view {

using hive::http::Address, hive::http::Pass, hive::http::Request;

/// Number of viewers, and its limit.
struct Browsers {
    std::size_t now = 0, most = 0;
};

struct Answer : hive::http::Answer {
    enum { text, image, stream } what = text;  ///< an image or a Stream takes the place of the body
    bool plain = false;                        ///< of images without captions
};

Answer answer_to(const Request& request, const Exchange& exchange, const Address& bind, const Pass& pass,
                 Browsers browsers);
/// The answer after waiting too long for an image.
Answer not_ready();

}  // namespace view
