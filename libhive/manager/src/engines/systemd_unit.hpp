// A drone as a unit of systemd.
#pragma once

#include <hive/program.hpp>
#include <hive/swarm_plan.hpp>

#include <filesystem>
#include <string>

namespace hive {

/// That a drone cannot have a restart which systemd would not tell from being stopped.
Error restart_refused(const std::string& drone);

/// "hive-face-1.service"
std::string unit_name(const std::string& drone);

/// A word of a command line as systemd reads it back.
std::string quoted_for_systemd(const std::string& word);

/// The line of a unit that sets NAME=VALUE.
std::string environment_line(const std::string& variable);

/// The lines of a unit by which systemd hears from the drone that it is ready, which may take as long as a large
/// network takes to load, and that its process is alive. A wrapper may be around it.
std::string unit_supervision();

/// The unit file.
/// @param command  runs the drone, with all of its arguments and its environment
/// @param log      takes what it says
/// Throws Errc::unsupported for a restart that systemd could not be told.
std::string unit_text(const SwarmDrone& drone, const DroneCommand& command, const std::filesystem::path& log);

}  // namespace hive
