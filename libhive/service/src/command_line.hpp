// The command line that all drones share, read into settings.
#pragma once

#include "drone_core.hpp"

#include <optional>

namespace hive::service {

/// Returns the settings, and opens the program's log. Nothing: the command line was answered (--help, --version) or
/// refused on stderr, and the program has to exit with `exit_code`.
std::optional<DroneSettings> read_command_line(int argc, const char* const* argv, const DroneProgram& program,
                                               int& exit_code);

/// Throws Errc::invalid_argument for an invalid address, Errc::not_permitted for an address at which any peer could
/// control the drone.
void require_sound(const ListenWish& wish);

/// Prints on stderr why the program exits, and returns the exit code.
int complain(const DroneProgram& program, const Error& error);

}  // namespace hive::service
