// The memory that the kernel's control groups leave to this process: of a container, a slice, a job.
#pragma once

#include <cstdint>
#include <optional>

namespace hive::platform {

struct GroupMemory {
    std::int64_t limit = 0, available = 0;  ///< bytes
};

/// That of its group and those above it which has the least available; version 1 and 2. Nothing: none has a limit. At
/// the limit, the kernel kills a process of the group, however much memory the machine has.
[[nodiscard]] std::optional<GroupMemory> group_memory();

}  // namespace hive::platform
