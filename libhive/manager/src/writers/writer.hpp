// The export forms of a swarm, one file each.
#pragma once

#include <hive/swarm_export.hpp>

namespace hive {

using ExportedFiles = std::vector<ExportedFile>;

ExportedFiles write_systemd(const SwarmPlan& plan, const ExportOptions& options);
ExportedFiles write_compose(const SwarmPlan& plan, const ExportOptions& options);
ExportedFiles write_kubernetes(const SwarmPlan& plan, const ExportOptions& options);
ExportedFiles write_slurm(const SwarmPlan& plan, const ExportOptions& options);
ExportedFiles write_shell(const SwarmPlan& plan, const ExportOptions& options);

}  // namespace hive
