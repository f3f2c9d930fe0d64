// A fake of the engines of exported swarms: runs the command lines of an exported swarm as its engine would, with the
// environment, files and host names of the form. Needs a Lab, and Python's yaml.
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

    /// Also stops background processes of a script.
    ~EngineLab();
    EngineLab(const EngineLab&) = delete;
    EngineLab& operator=(const EngineLab&) = delete;

    [[nodiscard]] const std::vector<std::string>& drones() const { return names_; }
    /// Runs the command line of a drone, without waiting until it is ready.
    void start(const std::string& drone);
    /// Call it when all are started: runs the rest of a script. Returns when hivectl has their places.
    void finish() const;
    /// SIGKILL.
    void kill(const std::string& drone);
    /// Kills all drones and empties their homes, like a folder that lasts until a reboot.
    void reboot();
    /// Is the drone healthy by the engine's check in the form?
    [[nodiscard]] bool is_well(const std::string& drone) const;
    /// Runs a command next to a drone, in the drone's environment.
    [[nodiscard]] Finished beside(const std::string& drone, const std::vector<std::string>& words) const;
    /// Runs a shell command with hivectl: on the drones' machine, or else on one that has their places.
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
