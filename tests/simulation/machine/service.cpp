// The functions of service that wait or exit the process.
#include "world.hpp"

#include "command_line.hpp"
#include "last_grace.hpp"
#include "log_line.hpp"

namespace hive::service {

/// Its code always returns.
void LastGrace::begin(const std::filesystem::path&, std::chrono::seconds) {}

void write_log_line(LogLevel, const std::string&, const std::string&) {}

std::optional<DroneSettings> read_command_line(int, const char* const*, const DroneProgram&, int&) { return {}; }
void require_sound(const ListenWish&) {}

}  // namespace hive::service
