// An address to listen at, as people write it.
#pragma once

#include <hive/transport/address.hpp>

#include <cstdint>
#include <string>

namespace hive::transport {

/// A drone that is told no port takes the first free one of these.
inline constexpr std::uint16_t first_drone_port = 7700, last_drone_port = 9699;

/// Reads tcp://HOST beside what parse_address reads: the port is 0, which means that the listener chooses it. Throws
/// Errc::invalid_argument.
Address listen_address(const std::string& text);

}  // namespace hive::transport
