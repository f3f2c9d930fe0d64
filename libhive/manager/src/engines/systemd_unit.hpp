// Writes the systemd unit of a drone.
#pragma once

#include <hive/program.hpp>
#include <hive/swarm_plan.hpp>

#include <filesystem>
#include <string>

namespace hive {

/// The error for `restart: always`, with which hivectl stop could not stop the unit.
Error restart_refused(const std::string& drone);

/// The error for drones of another machine.
Error systemd_refused(const std::string& host);

/// "hive-face-1.service"
std::string unit_name(const std::string& drone);

/// Quotes an argument for systemd.
std::string quoted_for_systemd(const std::string& word);

/// The line of a unit that sets NAME=VALUE.
std::string environment_line(const std::string& variable);

/// The lines of a unit for the drone's notifications that it is ready, which may take as long as loading a large
/// network, and that its process is alive. The process may be a child of a wrapper.
std::string unit_supervision();

/// The lines of a unit that limit the drone to the processors and memory of its file.
std::string unit_limits(const SwarmDrone& drone);

/// The unit file.
/// @param command  runs the drone, with all arguments and environment variables
/// @param log      file for its output
/// Throws Errc::unsupported for `restart: always`, see restart_refused().
std::string unit_text(const SwarmDrone& drone, const DroneCommand& command, const std::filesystem::path& log);

}  // namespace hive
