// Finds another name for a file that must not be overwritten.
#pragma once

#include <filesystem>
#include <string>

namespace next_free {

/// "run-2.hive" for "run.hive", "run-3.hive" for that, "run-2/" for "run/"; the first that does not exist.
/// @param folder  base of a relative `file`; empty: the working directory
std::string after(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace next_free
