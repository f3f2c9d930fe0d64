// Asking the kernel.
#include "usage.hpp"

#include <fstream>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace hive::bench {
namespace {

double seconds_of(const timeval& time)
{
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

Usage usage_of(int who)
{
    rusage usage{};
    ::getrusage(who, &usage);
    return {seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime), usage.ru_nvcsw, usage.ru_minflt};
}

}  // namespace

Usage own_usage() { return usage_of(RUSAGE_SELF); }
Usage children_usage() { return usage_of(RUSAGE_CHILDREN); }

double machine_cpu()
{
    std::ifstream file("/proc/stat");
    std::string cpu;
    double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, hard = 0, soft = 0;
    if (!(file >> cpu >> user >> nice >> system >> idle >> waiting >> hard >> soft))
        return 0;
    return (user + nice + system + hard + soft) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace hive::bench
