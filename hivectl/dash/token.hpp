// The token of the page, which stays the same when hivectl dash is started again: open pages go on.
#pragma once

#include <filesystem>
#include <string>

namespace hivectl::dash {

/// That of the file, or a fresh one that is written there with mode 0600. Throws Errc::io.
std::string lasting_token(const std::filesystem::path& file);

}  // namespace hivectl::dash
