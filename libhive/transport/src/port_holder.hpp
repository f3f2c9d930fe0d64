// Who listens at a port of this machine, for errors that say so.
#pragma once

#include <cstdint>
#include <string>

namespace hive::transport {

/// "hive-camera, process 4711". Empty when it cannot be told: the process of another user is not shown to everybody.
std::string holder_of_port(std::uint16_t port);

}  // namespace hive::transport
