// Runs a drone that is one Python file.
#pragma once

#include <hive/program.hpp>

namespace hive {

/// Is it an executable regular file?
bool is_program(const std::filesystem::path& file);

/// Uses the first interpreter with the modules that the file imports at its top: $HIVE_PYTHON alone, or that of the
/// active environment, python3 in $PATH and /usr/bin/python3. Throws Errc::not_found if there is no such file or
/// interpreter; the text names each interpreter and its missing modules.
DroneCommand command_of_python_file(const std::string& kind);

}  // namespace hive
