// Finds the programs of drones: hive-KIND next to the running program, in $HIVE_DRONE_PATH, in $PATH; or a Python file.
#pragma once

#include <hive/interface.hpp>
#include <hive/status.hpp>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hive {

/// The absolute path of a kind's program.
std::optional<std::filesystem::path> program_of(const std::string& kind);
/// All kinds that can be started, sorted; without those in the file .hive-unlisted next to them, one per line.
std::vector<std::string> kinds();

/// The kind of a drone by its name, if the kind has a program: "face" of "face" and "face-2".
std::optional<std::string> kind_by_name(const std::string& drone);
/// "hivectl start face --as face-2"
std::string start_command(const std::string& kind, const std::string& drone);

/// Is this kind a Python file: "edges.py", "drones/edges.py"?
bool is_python_file(const std::string& kind);
/// The default name of a drone: its kind, or "edges" of "drones/edges.py".
std::string usual_name(const std::string& kind);

/// The command of a drone: a program, its arguments before those of the drone, and its environment.
struct DroneCommand {
    std::filesystem::path program;
    std::vector<std::string> arguments;
    std::vector<std::string> environment;  ///< NAME=VALUE
};

/// "fps=30": a parameter as a drone's command line accepts it.
std::string assignment(const std::string& parameter, const Json& value);

/// Throws Errc::not_found if there is no such program or file, or no interpreter has the modules that the file imports:
/// $HIVE_PYTHON alone, or that of the active environment, python3 in $PATH and /usr/bin/python3.
DroneCommand command_of(const std::string& kind);

/// Is the running drone what this kind starts? Compares with what the drone reports it was started as, "face" or
/// "/home/me/edges.py", which "edges.py" matches on any machine, or else with its own kind. Throws as interface_of.
bool is_of_kind(const Status& running, const std::string& kind);

/// Inputs, outputs and parameters of this kind, as its program prints them for --describe. Throws as command_of,
/// Errc::timeout after `limit`, and Errc::failed if the program prints something else.
Interface interface_of(const std::string& kind, std::chrono::milliseconds limit = std::chrono::seconds(10));

}  // namespace hive
