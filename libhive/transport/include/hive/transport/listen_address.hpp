// An address to listen at, as people write it.
#pragma once

#include <hive/transport/address.hpp>

#include <string>

namespace hive::transport {

/// From these a drone chooses its port itself.
constexpr std::uint16_t first_own_port = 7700, last_own_port = 7955;

/// Reads tcp://HOST beside what parse_address reads: the port is 0, which means that the listener chooses it. Throws
/// Errc::invalid_argument.
Address listen_address(const std::string& text);

}  // namespace hive::transport
