// Resource usage of this process and its machine. Chosen at link time, as the clocks are.
#pragma once

#include <cstdint>

namespace hive::platform {

struct ProcessUsage {
    std::int64_t cpu_us = 0;  ///< of all processors, since the process started
    std::int64_t memory = 0;  ///< bytes in use
};

struct MachineUsage {
    std::int64_t processors = 0;
    std::int64_t cpu_us = 0;  ///< of all processors and processes, since the machine started
    /// Bytes, and those of them that are available to programs without swapping: of the machine, or of a control group
    /// of this process if that has fewer available.
    std::int64_t memory = 0, memory_available = 0;
    bool memory_limited = false;  ///< `memory` is the limit of a control group
};

/// Values that the system does not provide are 0. The machine's memory is at most 500 ms old.
[[nodiscard]] ProcessUsage process_usage();
[[nodiscard]] MachineUsage machine_usage();

}  // namespace hive::platform
