// Reads /proc.
#include "control_group.hpp"

#include <hive/platform/usage.hpp>

#include <chrono>
#include <fstream>
#include <limits>
#include <mutex>
#include <optional>
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

struct Memory {
    std::int64_t total = 0, available = 0;
    bool limited = false;
};

Memory memory_now()
{
    Memory memory;
    std::ifstream file("/proc/meminfo");
    std::int64_t kibibytes = 0;
    bool found = false;  // it is the third of some fifty lines
    for (std::string name; !found && file >> name >> kibibytes;
         file.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
        if (name == "MemTotal:")
            memory.total = kibibytes * 1024;
        found = name == "MemAvailable:";
        if (found)
            memory.available = kibibytes * 1024;
    }
    if (const auto group = group_memory(); group && group->available < memory.available)
        memory = {group->limit, group->available, true};
    return memory;
}

/// Several watchers share one reading: it takes longer than the rest of a status, and memory changes slowly. The time
/// of the processors is read each time, since a difference of two is a rate.
Memory recent_memory()
{
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds max_age(500);
    static std::mutex mutex;
    static Memory last;
    static std::optional<Clock::time_point> read_at;
    const std::lock_guard lock(mutex);
    if (const auto now = Clock::now(); !read_at || now - *read_at >= max_age) {
        last = memory_now();
        read_at = now;
    }
    return last;
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
    const auto memory = recent_memory();
    return {.processors = ::sysconf(_SC_NPROCESSORS_ONLN),
            .cpu_us = machine_cpu_us(),
            .memory = memory.total,
            .memory_available = memory.available,
            .memory_limited = memory.limited};
}

}  // namespace hive::platform
