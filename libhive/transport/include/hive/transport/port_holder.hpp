// Who listens at a port of this machine, for errors that say so.
#pragma once

#include <cstdint>
#include <string>

namespace hive::transport {

/// "hive-camera, process 4711". Empty when it cannot be told: the process of another user is not shown to everybody.
/// Looks at the files of all processes, so it takes milliseconds, and more the more processes there are.
std::string holder_of_port(std::uint16_t port);

}  // namespace hive::transport
