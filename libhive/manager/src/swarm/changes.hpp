// Executes and undoes the steps of bringing a swarm up.
#pragma once

#include <hive/swarm.hpp>

#include <vector>

namespace hive::swarm {

class Changes {
public:
    explicit Changes(Application& application) : application_(application) {}

    /// Throws the error that the drone answers; then this step has changed nothing.
    void make(const SwarmStep& step);
    /// Undoes all steps, the last first. Returns those that cannot be undone.
    std::vector<SwarmFailure> undo();

private:
    void change(const std::string& drone, const Json& fields);
    void undo(const SwarmStep& step);

    Application& application_;
    std::vector<SwarmStep> made_;
};

}  // namespace hive::swarm
