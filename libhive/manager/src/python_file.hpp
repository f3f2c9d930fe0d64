// A drone that is one file of Python, and no program of a kind: how it is run.
#pragma once

#include <hive/program.hpp>

namespace hive {

/// A file that may be run.
bool is_program(const std::filesystem::path& file);

/// With the first interpreter that has the modules that the file imports at its top: $HIVE_PYTHON alone, or that of the
/// active environment, python3 in $PATH and /usr/bin/python3. Throws Errc::not_found when there is no such file or no
/// such interpreter; the text names each interpreter and what it lacks.
DroneCommand command_of_python_file(const std::string& kind);

}  // namespace hive
