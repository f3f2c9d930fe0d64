// The versions of the library and of the protocol.
#pragma once

namespace hive {

/// The library: "0.1.0".
const char* version() noexcept;
/// The protocol; modules with different versions refuse each other.
int protocol_version() noexcept;

}  // namespace hive
