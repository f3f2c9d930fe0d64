// Which addresses the drone connects to: a camera's name must not lead it into this machine or to its neighbours'
// metadata.
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
    /// @throws std::invalid_argument  naming what is no address
    explicit AddressRule(const std::string& named);

    [[nodiscard]] bool allows(const sockaddr& address) const;
    bool operator==(const AddressRule&) const = default;

private:
    std::vector<std::string> named_;  ///< the bytes of each, IPv4 as IPv4 whatever form it came in
};

/// As people write it, without the port.
std::string address_text(const sockaddr& address);

}  // namespace axis
