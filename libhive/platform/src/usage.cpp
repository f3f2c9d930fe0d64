// Reads /proc.
#include "control_group.hpp"

#include <hive/platform/usage.hpp>

#include <fstream>
#include <limits>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace hive::platform {
namespace {

constexpr std::int64_t second_us = 1'000'000;

std::int64_t microseconds(const timeval& time) { return time.tv_sec * second_us + time.tv_usec; }

/// The busy time by the first line of /proc/stat: "cpu user nice system idle iowait irq softirq steal ...", in ticks.
/// Time stolen by other virtual machines counts as busy.
std::int64_t machine_cpu_us()
{
    std::ifstream file("/proc/stat");
    std::string word;
    std::int64_t user = 0, nice = 0, system = 0, idle = 0, waits = 0, irq = 0, softirq = 0, steal = 0;
    file >> word >> user >> nice >> system >> idle >> waits >> irq >> softirq >> steal;
    return (user + nice + system + irq + softirq + steal) * (second_us / ::sysconf(_SC_CLK_TCK));
}

}  // namespace

ProcessUsage process_usage()
{
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    std::int64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages >> pages;  // the second number: those that are resident
    return {.cpu_us = microseconds(used.ru_utime) + microseconds(used.ru_stime),
            .memory = pages * ::sysconf(_SC_PAGESIZE)};
}

MachineUsage machine_usage()
{
    MachineUsage usage{.processors = ::sysconf(_SC_NPROCESSORS_ONLN), .cpu_us = machine_cpu_us()};
    std::ifstream file("/proc/meminfo");
    std::int64_t kibibytes = 0;
    for (std::string name; file >> name >> kibibytes; file.ignore(std::numeric_limits<std::streamsize>::max(), '\n'))
        if (name == "MemTotal:")
            usage.memory = kibibytes * 1024;
        else if (name == "MemAvailable:")
            usage.memory_available = kibibytes * 1024;
    if (const auto group = group_memory(); group && group->available < usage.memory_available) {
        usage.memory = group->limit;
        usage.memory_available = group->available;
        usage.memory_limited = true;
    }
    return usage;
}

}  // namespace hive::platform
