// The inputs at which drones failed, as rows of a table and as files.
#pragma once

#include "words/table.hpp"

#include <hive/application.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hivectl {

/// As `hivectl exceptions` prints it. "seq" and "source" are those of its first input.
Row failure_row(const hive::KeptFailure& failure);
/// Writes the body of each input as a file that other programs can open, if possible, with its header and the failure
/// next to it: face-3.image.jpg and face-3.image.json; and all together for hivectl rerun: face-3.failure. Readable by
/// the user alone.
/// @param failure  with bodies
/// @return         the files, without the directory
/// @throws Error   refused: a file of this name exists, and nothing was overwritten; io
std::vector<std::string> save_failure(hive::Application& application, const hive::KeptFailure& failure,
                                      const std::filesystem::path& directory);
/// Creates a file that only the user can read.
/// @throws Error  refused: it exists; io
void write_new(const std::filesystem::path& file, std::string_view bytes);

}  // namespace hivectl
