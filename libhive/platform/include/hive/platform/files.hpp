// The file writes between which a process may crash, and locks. Chosen at link time, as the clocks are.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <system_error>

namespace hive::platform {

/// Writes a file that only its owner can read. @return false on failure, with errno set
[[nodiscard]] bool write_private(const std::filesystem::path& file, const std::string& text);
/// Replaces a file atomically.
[[nodiscard]] std::error_code rename(const std::filesystem::path& from, const std::filesystem::path& to);
/// Takes the exclusive lock of an open file or folder, which is released when the descriptor is closed.
/// @return std::errc::timed_out if other processes have held it for that long
[[nodiscard]] std::error_code lock(int descriptor, std::chrono::nanoseconds timeout);

}  // namespace hive::platform
