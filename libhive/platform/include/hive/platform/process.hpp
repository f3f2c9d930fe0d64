// Functions for this process and others on this machine. Chosen at link time, as the clocks are.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hive::platform {

[[nodiscard]] std::int64_t own_pid() noexcept;
/// Is that process exiting, or gone?
[[nodiscard]] bool process_ends(std::int64_t pid);
/// Was it suspended, as by SIGSTOP or Ctrl-Z?
[[nodiscard]] bool process_is_suspended(std::int64_t pid);
/// Kills it with SIGKILL.
void kill_process(std::int64_t pid);
/// The number of descriptors that this process may have.
[[nodiscard]] std::size_t most_descriptors();
/// An unpredictable number.
[[nodiscard]] std::uint64_t entropy();

}  // namespace hive::platform
