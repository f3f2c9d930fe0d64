// Writes to files that a crash may separate. Chosen at link time, as the clocks are.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace hive::platform {

/// Writes a file that only its owner reads. @return false when that fails, with errno set
[[nodiscard]] bool write_private(const std::filesystem::path& file, const std::string& text);
/// Puts a file in the place of another one, at once.
[[nodiscard]] std::error_code rename(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace hive::platform
