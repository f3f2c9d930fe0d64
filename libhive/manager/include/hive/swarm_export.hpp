// A swarm written for an engine that people have: as units, manifests or scripts, in which the command line of each
// drone alone is enough for it to come back with its parameters and its connections.
#pragma once

#include <hive/swarm_plan.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace hive {

struct ExportedFile {
    std::string name;  ///< "hive-doorway.target"; of several machines in a folder for each: "cam1/hive-doorway.target"
    std::string text;
    bool is_program = false;  ///< to be made executable
};

struct ExportOptions {
    std::string programs = "/usr/bin";  ///< where hive-KIND is, for what needs whole paths
    std::string image = "hive:latest";  ///< of containers
    bool metrics = false;  ///< with a container that serves the metrics of the swarm to Prometheus; for containers only
};

/// "systemd", "compose", "kubernetes", "slurm", "shell".
const std::vector<std::string>& export_forms();

/// The files of one form; the first one begins with a comment that says how they are used. The outputs of connections
/// must be named in the plan, as check_swarm fills them in. Throws Errc::invalid_argument for another form, and when
/// the form cannot say what the plan does.
std::vector<ExportedFile> export_swarm(const SwarmPlan& plan, std::string_view form, const ExportOptions& options = {});

/// What drones of the plan need and the form does not carry along, a sentence each: files of Python, files that are
/// read or written, devices. export_swarm() writes the same into the head of the first file.
std::vector<std::string> export_notes(const SwarmPlan& plan, std::string_view form);

}  // namespace hive
