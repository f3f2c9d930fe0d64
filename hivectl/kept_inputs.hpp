// The inputs at which drones failed, as rows of a table and as files.
#pragma once

#include "table.hpp"

#include <hive/kept_failure.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace hivectl {

/// As `hivectl exceptions` prints it. "seq" and "source" are those of its first input.
Row failure_row(const hive::KeptFailure& failure);
/// Writes the body of each input as a file that other programs can open, if possible, with its header and the failure
/// next to it: face-3.image.jpg and face-3.image.json, readable by the user alone.
/// @param failure  with bodies
/// @return         the files, without the directory
/// @throws Error   refused: a file of this name exists, and nothing was overwritten; io
std::vector<std::string> save_failure(const hive::KeptFailure& failure, const std::filesystem::path& directory);

}  // namespace hivectl
