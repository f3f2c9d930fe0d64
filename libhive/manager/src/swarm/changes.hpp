// Executes and undoes the steps of bringing a swarm up.
#pragma once

#include <hive/swarm.hpp>

#include <span>
#include <vector>

namespace hive::swarm {

class Changes {
public:
    explicit Changes(Application& application) : application_(application) {}

    /// Makes a step, or several connections at once. Returns the errors that drones answer; these steps have changed
    /// nothing.
    std::vector<SwarmFailure> make(std::span<const SwarmStep> steps);
    /// Undoes all steps, the last first. Returns those that cannot be undone.
    std::vector<SwarmFailure> undo();

private:
    std::vector<SwarmFailure> connect(std::span<const SwarmStep> steps);
    void make(const SwarmStep& step);
    void change(const std::string& drone, const Json& fields);
    void undo(const SwarmStep& step);

    Application& application_;
    std::vector<SwarmStep> made_;
};

}  // namespace hive::swarm
