// Processor time, switches and page faults: of this process, of its children, and of the whole machine.
#pragma once

#include <cstdint>

namespace hive::bench {

struct Usage {
    double cpu = 0;                       ///< seconds, user and system, all threads
    std::int64_t voluntary_switches = 0;  ///< a thread went to sleep: each is a hand-over to another
    std::int64_t page_faults = 0;         ///< without input or output

    Usage operator-(const Usage& earlier) const
    {
        return {cpu - earlier.cpu, voluntary_switches - earlier.voluntary_switches, page_faults - earlier.page_faults};
    }
};

Usage own_usage();
/// Of the children that have been waited for.
Usage children_usage();
/// Processor seconds that anybody on this machine has used, by /proc/stat; 0 where it cannot be read.
double machine_cpu();

}  // namespace hive::bench
