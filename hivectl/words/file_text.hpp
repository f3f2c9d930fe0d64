// Reads a whole file or stdin.
#pragma once

#include <cstddef>
#include <string>

namespace hivectl {

/// @param file  "-": stdin
/// Throws Errc::io if it cannot be read, Errc::too_large for more than `most` bytes.
std::string text_of_file(const std::string& file, std::size_t most);

}  // namespace hivectl
