// Restarts the drones of which only a new process has what the plan says, and undoes that.
#pragma once

#include "differences.hpp"
#include "starting.hpp"

namespace hive::swarm {

class Restarting {
public:
    /// @param differences  has to outlive it
    Restarting(Application& application, const Differences& differences);

    /// Stops them, starts them as they are wanted, and makes the connections again that ended with them.
    std::vector<SwarmFailure> run(std::chrono::milliseconds patience, const SwarmWatch& watch);
    /// They run again as before. What cannot be undone is told.
    std::vector<SwarmFailure> undo();

private:
    std::vector<SwarmFailure> connect(const std::vector<SwarmConnection>& connections);

    Application& application_;
    const Differences& differences_;
    std::vector<std::string> drones_{};
    Starting now_, before_;
    bool begun_ = false;
};

/// The errors, but for drones that do not run.
std::vector<SwarmFailure> failures_in(const std::vector<Answer>& answers);

}  // namespace hive::swarm
