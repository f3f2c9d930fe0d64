// The texts of units.
#include "systemd_unit.hpp"

#include "engine.hpp"

namespace hive {

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

std::string unit_name(const std::string& drone) { return "hive-" + drone + ".service"; }

/// A % would start a specifier, and a $ a variable.
std::string quoted_for_systemd(const std::string& text)
{
    std::string result = "\"";
    for (const char c : doubled(doubled(text, '%'), '$'))
        if (c == '"' || c == '\\')
            result += std::string("\\") + c;
        else if (c == '\n')
            result += "\\n";
        else if (static_cast<unsigned char>(c) < ' ' || c == 0x7F)
            result += hex_escape(c);  // a line ends at a carriage return as well
        else
            result += c;
    return result + "\"";
}

std::vector<std::string> unit_properties(const SwarmDrone& drone)
{
    std::vector<std::string> properties{"Type=notify", "NotifyAccess=all", "TimeoutStartSec=300", "WatchdogSec=30"};
    if (drone.cpus > 0)
        properties.push_back("CPUQuota=" + std::to_string(drone.cpus * 100) + "%");
    if (drone.memory_mib > 0)
        properties.push_back("MemoryMax=" + std::to_string(drone.memory_mib) + "M");
    return properties;
}

}  // namespace hive
