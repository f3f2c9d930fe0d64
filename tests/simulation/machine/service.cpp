// The functions of service that wait or exit the process.
#include "world.hpp"

#include "command_line.hpp"
#include "shutdown_watchdog.hpp"
#include "log_line.hpp"

#include <hive/platform/process.hpp>

namespace hive::service {

using simulation::world;

void ShutdownWatchdog::begin(const std::filesystem::path&, std::chrono::seconds grace)
{
    // Killing a process that has ended has no effect, and pids are not reused.
    world().at(world().now() + grace, [pid = platform::own_pid()] { world().kill(pid); });
}

void write_log_line(LogLevel, const std::string&, const std::string&) {}

/// What the manager writes for a drone.
std::optional<DroneSettings> read_command_line(int count, const char* const* words, const DroneProgram& program, int&)
{
    DroneSettings settings;
    settings.name = program.kind;
    settings.signals = false;
    settings.log = [process = world().current()](LogLevel, const std::string& text) {
        if (process->log)
            process->log(text);
    };
    for (int i = 1; i < count; ++i) {
        const std::string_view option(words[i]);
        if (option == "--describe") {
            settings.describe = true;
            continue;
        }
        const std::string value(words[++i]);
        if (option == "--name")
            settings.name = value;
        else if (option == "--set")
            settings.parameters[value.substr(0, value.find('='))] = value.substr(value.find('=') + 1);
        else if (option == "--take-over")
            settings.take_over = event::Clock::now() + std::chrono::seconds(std::stoi(value));
        else if (option == "--on-exception")
            settings.order.on_exception = value;
        else
            throw Error(Errc::invalid_argument, "unexpected argument " + std::string(option));
    }
    return settings;
}
void require_sound(const ListenWish&) {}

}  // namespace hive::service
