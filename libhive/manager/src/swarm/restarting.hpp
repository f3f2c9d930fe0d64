// Restarts drones that only a new process can make match the plan, and undoes that.
#pragma once

#include "differences.hpp"
#include "starting.hpp"

namespace hive::swarm {

class Restarting {
public:
    /// @param differences  must outlive this object
    Restarting(Application& application, const Differences& differences);

    /// Stops them, starts them as planned, and restores the connections that ended with them.
    std::vector<SwarmFailure> run(std::chrono::milliseconds timeout, const SwarmWatch& watch);
    /// Restores them as they were. Returns what cannot be undone.
    std::vector<SwarmFailure> undo();

private:
    std::vector<SwarmFailure> stop();
    void stop_new_processes();
    void disconnect(const SwarmConnection& connection);
    std::vector<SwarmFailure> connect(const std::vector<SwarmConnection>& connections);

    Application& application_;
    const Differences& differences_;
    std::vector<std::string> drones_{}, back_{}, moved_{};  ///< all; those that come back on their machine, or not
    Starting now_, before_;
    bool begun_ = false;
};

/// The errors, without those of drones that are not running.
std::vector<SwarmFailure> failures_in(const std::vector<Answer>& answers);

}  // namespace hive::swarm
