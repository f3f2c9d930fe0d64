// Keeps the drone from writing to a FIFO, a device or a socket: opening a FIFO would wait for its reader forever.
#pragma once

#include <filesystem>

namespace writing {

/// Call it before opening a path for writing.
/// @throws std::runtime_error  the path is not a regular file
void require_regular_or_missing(const std::filesystem::path& path);

}  // namespace writing
