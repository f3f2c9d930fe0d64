// The programs of drones: hive-KIND beside the running program, in $HIVE_DRONE_PATH, in $PATH; or one file of Python.
#pragma once

#include <hive/interface.hpp>
#include <hive/status.hpp>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hive {

/// The program of a kind, absolute.
std::optional<std::filesystem::path> program_of(const std::string& kind);
/// All kinds that can be started, sorted; without those that the file .hive-unlisted beside them names, one a line.
std::vector<std::string> kinds();

/// The kind of a drone by its name, if there is a program of it: "face" of "face" and "face-2".
std::optional<std::string> kind_by_name(const std::string& drone);
/// "hivectl start face --as face-2"
std::string start_command(const std::string& kind, const std::string& drone);

/// Is what the user calls a kind a file of Python: "edges.py", "drones/edges.py"?
bool is_python_file(const std::string& kind);
/// The name of a drone unless it is given another one: its kind, or "edges" of "drones/edges.py".
std::string usual_name(const std::string& kind);

/// What runs a drone: a program, its arguments before those of the drone, and what it needs in its environment.
struct DroneCommand {
    std::filesystem::path program;
    std::vector<std::string> arguments;
    std::vector<std::string> environment;  ///< NAME=VALUE
};

/// "fps=30": a parameter as the command line of a drone takes it.
std::string assignment(const std::string& parameter, const Json& value);

/// Throws Errc::not_found when there is no such program or file, or no interpreter that has what the file imports:
/// $HIVE_PYTHON alone, or that of the active environment, python3 in $PATH and /usr/bin/python3.
DroneCommand command_of(const std::string& kind);

/// Is the running drone what this kind starts? A drone tells what it was started as, "edges.py"; of one that does not,
/// its own kind decides. Throws as interface_of.
bool is_of_kind(const Status& running, const std::string& kind);

/// What drones of this kind take, produce and have as parameters: what its program prints for --describe. Throws as
/// command_of, Errc::timeout when it has not answered within `limit`, Errc::failed when it answers with something else.
Interface interface_of(const std::string& kind, std::chrono::milliseconds limit = std::chrono::seconds(10));

}  // namespace hive
