// Properties of a drone's systemd unit, for the unit files of an export and for systemd-run.
#pragma once

#include <hive/swarm_plan.hpp>

#include <string>
#include <vector>

namespace hive {

/// The error for `restart: always`, with which hivectl stop could not stop the unit.
Error restart_refused(const std::string& drone);

/// The error for drones of another machine.
Error systemd_refused(const std::string& host);

/// "hive-face-1.service"
std::string unit_name(const std::string& drone);

/// Quotes an argument of a unit file, with the quoting of systemd.syntax(7) and systemd.service(5).
std::string quoted_for_systemd(const std::string& word);

/// "Type=notify", "MemoryMax=512M": the drone's notifications that it is ready, which may take as long as loading a
/// large network, and that its process is alive, which may be a child of a wrapper; and the limits of its file.
std::vector<std::string> unit_properties(const SwarmDrone& drone);

}  // namespace hive
