// An address to listen at, as people write it.
#pragma once

#include <hive/transport/address.hpp>

#include <string>

namespace hive::transport {

/// Reads tcp://HOST beside what parse_address reads: the port is 0, which means that the listener chooses it. Throws
/// Errc::invalid_argument.
Address listen_address(const std::string& text);

}  // namespace hive::transport
