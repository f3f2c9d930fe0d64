// Which Hive this is.
#pragma once

namespace hive {

/// Of this library: "0.1.0".
const char* version() noexcept;
/// Of what travels between modules; two that speak different ones refuse each other.
int protocol_version() noexcept;

}  // namespace hive
