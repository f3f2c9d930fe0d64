// The file writes between which a process may crash. Chosen at link time, as the clocks are.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace hive::platform {

/// Writes a file that only its owner can read. @return false on failure, with errno set
[[nodiscard]] bool write_private(const std::filesystem::path& file, const std::string& text);
/// Replaces a file atomically.
[[nodiscard]] std::error_code rename(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace hive::platform
