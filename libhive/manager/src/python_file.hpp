// A drone that is one file of Python, and no program of a kind: how it is run.
#pragma once

#include <hive/program.hpp>

namespace hive {

/// A file that may be run.
bool is_program(const std::filesystem::path& file);

/// Throws Errc::not_found when there is no such file, or no interpreter: $HIVE_PYTHON, or python3 in $PATH.
DroneCommand command_of_python_file(const std::string& kind);

}  // namespace hive
