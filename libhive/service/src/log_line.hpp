// Writes a line of a drone to the log of its process.
#pragma once

#include <hive/drone.hpp>

#include <string>

namespace hive::service {

/// Any thread.
void write_log_line(LogLevel level, const std::string& drone, const std::string& text);

}  // namespace hive::service
