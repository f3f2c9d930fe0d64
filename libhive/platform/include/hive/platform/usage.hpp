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
    std::int64_t cpu_us = 0;            ///< of all processors and processes, since the machine started
    std::int64_t memory = 0;            ///< bytes
    std::int64_t memory_available = 0;  ///< bytes available to programs without swapping
};

/// Values that the system does not provide are 0.
[[nodiscard]] ProcessUsage process_usage();
[[nodiscard]] MachineUsage machine_usage();

}  // namespace hive::platform
