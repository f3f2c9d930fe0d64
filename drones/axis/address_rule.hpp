// Restricts the addresses to which the drone connects: a camera's name must not lead to this machine or to link-local
// metadata services.
#pragma once

#include <sys/socket.h>

#include <string>
#include <vector>

namespace axis {

/// Loopback, link-local, multicast, broadcast and unspecified addresses are refused unless they are named.
class AddressRule {
public:
    AddressRule() = default;
    /// @param named  IPv4 and IPv6 addresses, separated by commas
    /// @throws std::invalid_argument  naming the invalid address
    explicit AddressRule(const std::string& named);

    [[nodiscard]] bool allows(const sockaddr& address) const;
    bool operator==(const AddressRule&) const = default;

private:
    std::vector<std::string> named_;  ///< the bytes of each, IPv4 in 4 bytes, also if it was mapped to IPv6
};

/// As text, without the port.
std::string address_text(const sockaddr& address);

}  // namespace axis
