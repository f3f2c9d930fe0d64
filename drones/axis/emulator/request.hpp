// An HTTP request, as the emulated camera reads it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace axis::emulator {

struct Request {
    std::string method, target;                              ///< as received
    std::string path;                                        ///< without the query
    std::vector<std::pair<std::string, std::string>> query;  ///< decoded, in order
    std::string authorization;
    std::size_t body_size = 0;

    /// The value of a key of the query; empty if missing.
    [[nodiscard]] std::string word(std::string_view name) const;
};

/// @param head  up to and with the empty line; nothing if it is not a request
std::optional<Request> parse_request(std::string_view head);

/// a=1&b=%20 taken apart.
std::vector<std::pair<std::string, std::string>> parse_query(std::string_view text);

}  // namespace axis::emulator
