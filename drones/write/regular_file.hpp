// Keeps the drone from writing to a FIFO, a device or a socket: opening a FIFO would wait for its reader for ever.
#pragma once

#include <filesystem>

namespace writing {

/// Call it before a path is opened to write.
/// @throws std::runtime_error  something other than a regular file is there
void require_regular_or_missing(const std::filesystem::path& path);

}  // namespace writing
