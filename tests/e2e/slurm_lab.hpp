// A cluster of three nodes, n1 to n3, on this machine: slurmctld, three slurmd and munged with its own key. Needs root,
// and Debian's slurmctld, slurmd, slurm-client and munge.
#pragma once

#include "swarm.hpp"

#include <string>
#include <vector>

namespace hive::test {

/// What this machine lacks for it, or nothing.
std::string missing_for_slurm();

class SlurmLab {
public:
    /// Returns when the nodes are up and a job has all of them.
    SlurmLab();
    /// Ends the job; no step of it or of other ended jobs remains.
    ~SlurmLab();
    SlurmLab(const SlurmLab&) = delete;
    SlurmLab& operator=(const SlurmLab&) = delete;

    /// Ends the job, and submits a script to sbatch, whose job replaces it; its output goes to `sbatch.log` in the
    /// home.
    void submit(const std::filesystem::path& script);
    /// Runs a shell command inside of the allocation.
    [[nodiscard]] Finished shell(const std::string& line) const;
    std::string shell_done(const std::string& line) const;
    /// Runs hivectl there in the background.
    [[nodiscard]] Process hivectl_running(const std::vector<std::string>& words, const std::string& name) const;
    /// The names of running steps that are drones, sorted.
    [[nodiscard]] std::vector<std::string> steps() const;
    /// Processes of drones on a node, whether they answer or not; on all nodes without one.
    [[nodiscard]] std::size_t processes(const std::string& node = {}) const;
    [[nodiscard]] const std::string& job() const { return job_; }
    [[nodiscard]] const Swarm& swarm() const { return swarm_; }

private:
    void configure() const;
    void end_job() const;
    [[nodiscard]] Finished slurm(const std::vector<std::string>& words) const;
    [[nodiscard]] std::vector<std::string> variables() const;

    Swarm swarm_;
    std::filesystem::path directory_;
    std::vector<Process> daemons_;
    std::string job_;
};

}  // namespace hive::test
