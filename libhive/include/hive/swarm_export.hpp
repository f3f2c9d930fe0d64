// Exports a swarm as units, manifests or scripts of common service managers. Each drone's command line alone restores
// its parameters and connections.
#pragma once

#include <hive/swarm_plan.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace hive {

struct ExportedFile {
    std::string name;  ///< "hive-doorway.target"; with several machines, one folder each: "cam1/hive-doorway.target"
    std::string text;
    bool is_program = false;  ///< to be made executable
};

struct ExportOptions {
    std::string programs = "/usr/bin";  ///< where hive-KIND is, for forms that need absolute paths
    std::string image = "hive:latest";  ///< of containers
    bool metrics = false;  ///< adds a container that serves the swarm's metrics to Prometheus; for containers only
    /// Tells which parameters are paths of the drone's machine (Constraint::operator_only). If it is missing, or throws
    /// for a kind, every text that looks like a path counts as one.
    InterfaceOfKind interface_of{};
};

/// "systemd", "compose", "kubernetes", "slurm", "shell".
const std::vector<std::string>& export_forms();

/// The files of one form; the first one starts with a comment on their use. The plan must name the outputs of
/// connections, as check_swarm fills them in. Throws Errc::invalid_argument for an unknown form, and if the form cannot
/// express the plan.
std::vector<ExportedFile> export_swarm(const SwarmPlan& plan, std::string_view form, const ExportOptions& options = {});

/// What drones of the plan need and the form does not contain (Python files, files that are read or written, devices),
/// and what the form cannot carry, one sentence each. export_swarm() writes the same at the top of the first file.
std::vector<std::string> export_notes(const SwarmPlan& plan, std::string_view form, const ExportOptions& options = {});

}  // namespace hive
