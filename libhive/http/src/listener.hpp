// A TCP socket that listens.
#pragma once

#include <hive/http/host.hpp>
#include <hive/platform/descriptor.hpp>

#include <string>

namespace hive::http {

using platform::Descriptor;

/// Listens without blocking. Throws std::runtime_error: "cannot listen at …: Address already in use".
Descriptor listen_at(const Address& address, const std::string& url);
int port_of(const Descriptor& socket);

}  // namespace hive::http
