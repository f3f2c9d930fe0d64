// The command line that all drones share, read into settings.
#pragma once

#include "drone_core.hpp"

#include <optional>

namespace hive::service {

/// The settings; the log of the program is begun. Nothing: the line was answered (--help, --version) or refused on
/// stderr, and the program is to end with `exit_code`.
std::optional<DroneSettings> read_command_line(int argc, const char* const* argv, const DroneProgram& program,
                                               int& exit_code);

/// Throws Errc::invalid_argument for an address that means nothing, Errc::not_permitted for one where anybody could
/// control the drone.
void require_sound(const ListenWish& wish);

/// Says on stderr why a program ends, and with which exit code.
int complain(const DroneProgram& program, const Error& error);

}  // namespace hive::service
