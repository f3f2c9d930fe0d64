// Finds the process that listens at a port of this machine, for errors.
#pragma once

#include <cstdint>
#include <string>

namespace hive::transport {

/// "hive-camera, process 4711". Empty if unknown, since other users' processes may be hidden. Reads the files of all
/// processes, so it takes milliseconds, more with more processes.
std::string holder_of_port(std::uint16_t port);

}  // namespace hive::transport
