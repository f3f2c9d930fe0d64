// The token of the page. It survives restarts of hivectl dash, so that open pages keep working.
#pragma once

#include <filesystem>
#include <string>

namespace hivectl::dash {

/// Reads the file, or writes a new token to it with mode 0600. Throws Errc::io.
std::string lasting_token(const std::filesystem::path& file);

}  // namespace hivectl::dash
