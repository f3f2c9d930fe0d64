// The address of a module: a unix socket or a TCP endpoint.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace hive::transport {

struct Address {
    enum class Scheme { unix_socket, tcp };
    Scheme scheme = Scheme::unix_socket;
    std::string host;        ///< the path of a unix socket, or a host name or number
    std::uint16_t port = 0;  ///< tcp only; 0 when listening: any free port

    bool operator==(const Address&) const = default;
    /// A listener at all addresses of its machine; cannot be dialed.
    [[nodiscard]] bool is_everywhere() const { return host == "0.0.0.0" || host == "::"; }
};

/// Reads `unix:/path`, `tcp://HOST:PORT`, `tcp://[::1]:PORT`. Throws Errc::invalid_argument.
Address parse_address(std::string_view text);
/// The text that parse_address reads.
std::string to_text(const Address& address);

}  // namespace hive::transport
