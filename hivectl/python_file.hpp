// A drone that is one file of Python, and no program of a kind: how it is run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hivectl {

/// Is what the user calls a kind such a file: "edges.py", "drones/edges.py"?
bool is_python_file(const std::string& kind);
/// Its name in the swarm unless another one is given: "edges".
std::string name_of_python_file(const std::string& kind);

/// The interpreter, its arguments before those of the drone, and what it needs in its environment.
struct PythonRun {
    std::filesystem::path interpreter;
    std::vector<std::string> arguments;
    std::vector<std::string> environment;  ///< NAME=VALUE
};

/// Throws Errc::not_found when there is no such file, or no interpreter: $HIVE_PYTHON, or python3 in $PATH.
PythonRun run_of_python_file(const std::string& kind);

}  // namespace hivectl
