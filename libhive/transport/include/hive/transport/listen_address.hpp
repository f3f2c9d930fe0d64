// Reads an address to listen at, in which the port may be omitted.
#pragma once

#include <hive/transport/address.hpp>

#include <cstdint>
#include <string>

namespace hive::transport {

/// A drone without a given port takes the first free one of these.
inline constexpr std::uint16_t first_drone_port = 7700, last_drone_port = 9699;

/// Reads tcp://HOST in addition to what parse_address reads: port 0, which the listener chooses. Throws
/// Errc::invalid_argument.
Address listen_address(const std::string& text);

}  // namespace hive::transport
