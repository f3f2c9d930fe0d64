// Where the programs of drones are: hive-KIND beside hivectl, in $HIVE_DRONE_PATH, in $PATH.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hivectl {

/// The program of a kind, absolute.
std::optional<std::filesystem::path> program_of(const std::string& kind);
/// All kinds that can be started, sorted.
std::vector<std::string> kinds();

}  // namespace hivectl
