// A stand-in for the engines for which a swarm is written: runs the command lines of a written swarm as its engine
// would, with the environment, the files and the names of hosts that the form says. Needs what a Lab needs, and
// Python's yaml.
#pragma once

#include "lab.hpp"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hive::test {

/// What this machine lacks for it, or nothing.
std::string missing_for_engines();

class EngineLab {
public:
    /// @param form        of `hivectl export --as`
    /// @param swarm_file  a swarm without machines; a camera of the kind axis is emulated at 192.0.2.10
    EngineLab(std::string form, const std::filesystem::path& swarm_file);

    /// Ends also what a script has left in the background.
    ~EngineLab();
    EngineLab(const EngineLab&) = delete;
    EngineLab& operator=(const EngineLab&) = delete;

    [[nodiscard]] const std::vector<std::string>& drones() const { return names_; }
    /// Runs the command line of a drone; it need not have come up yet.
    void start(const std::string& drone);
    /// When all were started: what a script does then. Returns when hivectl knows where they are.
    void finish() const;
    /// SIGKILL.
    void kill(const std::string& drone);
    /// Kills all that run; homes are empty from now on, as they are in a folder that lasts until a reboot.
    void reboot();
    /// Whether the engine, which asks as the form says, would call the drone well.
    [[nodiscard]] bool is_well(const std::string& drone) const;
    /// A command beside a drone, with what the drone has.
    [[nodiscard]] Finished beside(const std::string& drone, const std::vector<std::string>& words) const;
    /// A line of a shell with hivectl: where the drones are, or else on a machine that knows where they are.
    [[nodiscard]] Finished shell(const std::string& line) const;
    std::string shell_done(const std::string& line) const;

private:
    struct Run {
        std::vector<std::string> words, probe, variables;
        std::string host;
        const Machine* machine = nullptr;
        std::optional<Process> process;
    };
    void add_machines(const Json& runs);
    [[nodiscard]] std::vector<std::string> inside(const Machine& machine, const std::vector<std::string>& variables,
                                                  const std::vector<std::string>& words) const;

    std::string form_;
    Swarm swarm_;  ///< the written files, and logs
    Namespace hub_;
    std::vector<std::unique_ptr<Machine>> machines_;  ///< the first one is where hivectl is
    std::map<std::string, Run> runs_;
    std::vector<std::string> names_;
    std::vector<std::vector<std::string>> then_;
    std::optional<Process> camera_;
    int boots_ = 0;
};

}  // namespace hive::test
