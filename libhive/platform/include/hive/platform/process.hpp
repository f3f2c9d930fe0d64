// What the library asks of its process and of others on this machine. Chosen at link time, as the clocks are.
#pragma once

#include <chrono>
#include <cstdint>

namespace hive::platform {

[[nodiscard]] std::int64_t own_pid() noexcept;
/// Is that process ending, or gone?
[[nodiscard]] bool process_ends(std::int64_t pid);
/// Was it suspended, as by SIGSTOP or Ctrl-Z?
[[nodiscard]] bool process_is_suspended(std::int64_t pid);
/// Ends it at once, whatever its code does.
void kill_process(std::int64_t pid);
/// Holds up the calling thread.
void sleep_for(std::chrono::nanoseconds time);
/// An unpredictable number.
[[nodiscard]] std::uint64_t entropy();

}  // namespace hive::platform
