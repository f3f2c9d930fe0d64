// Writes units, with the quoting of systemd.syntax(7) and systemd.service(5).
#include "systemd_unit.hpp"

#include <hive/error.hpp>
#include <hive/printable.hpp>

namespace hive {
namespace {

/// Without specifiers: a % is a %.
std::string without_specifiers(const std::string& text)
{
    std::string result;
    for (const char c : text)
        result += c == '%' ? "%%" : std::string(1, c);
    return result;
}

std::string escaped_byte(char c)
{
    constexpr std::string_view digits = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(c);
    return {'\\', 'x', digits[byte / 16], digits[byte % 16]};
}

/// Quotes one argument. In a command line, $ would start a variable.
std::string word(const std::string& text, bool of_command)
{
    std::string result = "\"";
    for (const char c : without_specifiers(text))
        if (c == '"' || c == '\\')
            result += std::string("\\") + c;
        else if (c == '\n')
            result += "\\n";
        else if (static_cast<unsigned char>(c) < ' ' || c == 0x7F)
            result += escaped_byte(c);  // a line ends at a carriage return as well
        else
            result += c == '$' && of_command ? "$$" : std::string(1, c);
    return result + "\"";
}

std::string command_line(const DroneCommand& command)
{
    std::string line = word(command.program.string(), true);
    for (const auto& argument : command.arguments)
        line += " " + word(argument, true);
    return line;
}

/// A stopped drone exits with 0, as one that has ended: systemd cannot distinguish the two.
std::string restart_of(const SwarmDrone& drone)
{
    switch (drone.restart) {
    case Restart::never: return "no";
    case Restart::on_failure: return "on-failure";
    case Restart::always: break;
    }
    throw restart_refused(drone.name);
}

}  // namespace

Error restart_refused(const std::string& drone)
{
    return {Errc::unsupported, drone + ": hivectl stop and down cannot stop a unit that systemd always restarts",
            "write \"restart\": \"on-failure\""};
}

Error systemd_refused(const std::string& host)
{
    return {Errc::unsupported, "systemd starts drones of this machine, and not of " + host,
            "leave that engine out; to have units written for each machine: hivectl export --as systemd"};
}

std::string quoted_for_systemd(const std::string& text) { return word(text, true); }

std::string unit_name(const std::string& drone) { return "hive-" + drone + ".service"; }

std::string environment_line(const std::string& variable) { return "Environment=" + word(variable, false) + "\n"; }

std::string unit_supervision() { return "Type=notify\nNotifyAccess=all\nTimeoutStartSec=300\nWatchdogSec=30\n"; }

std::string unit_limits(const SwarmDrone& drone)
{
    std::string text;
    if (drone.cpus > 0)
        text += "CPUQuota=" + std::to_string(drone.cpus * 100) + "%\n";
    if (drone.memory_mib > 0)
        text += "MemoryMax=" + std::to_string(drone.memory_mib) + "M\n";
    return text;
}

std::string unit_text(const SwarmDrone& drone, const DroneCommand& command, const std::filesystem::path& log)
{
    if (printable(log.string()) != log.string())
        throw Error(Errc::invalid_argument, "a unit cannot have the log " + in_quotes(log.string()),
                    "choose a runtime directory without line ends: HIVE_HOME");
    const auto file = "append:" + without_specifiers(log.string());
    std::string text = "# Written by hivectl up.\n[Unit]\nDescription=Hive drone " + drone.name + " ("
                       + without_specifiers(printable(drone.kind))
                       + ")\nStartLimitIntervalSec=60\nStartLimitBurst=5\n\n[Service]\n" + unit_supervision()
                       + unit_limits(drone) + "ExecStart=" + command_line(command) + "\n";
    for (const auto& variable : command.environment)
        text += environment_line(variable);
    return text + "StandardOutput=" + file + "\nStandardError=" + file + "\nRestart=" + restart_of(drone) + "\n";
}

}  // namespace hive
