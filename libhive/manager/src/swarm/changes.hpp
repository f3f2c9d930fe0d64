// Does the steps of bringing a swarm up, and undoes them.
#pragma once

#include <hive/swarm.hpp>

#include <vector>

namespace hive::swarm {

class Changes {
public:
    explicit Changes(Application& application) : application_(application) {}

    /// Throws what the drone answers; then nothing of this step is done.
    void make(const SwarmStep& step);
    /// The last first. What cannot be undone is told.
    std::vector<SwarmFailure> undo();

private:
    void change(const std::string& drone, const Json& fields);
    void undo(const SwarmStep& step);

    Application& application_;
    std::vector<SwarmStep> made_;
};

}  // namespace hive::swarm
