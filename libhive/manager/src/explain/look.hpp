// Queries the statuses of drones once, and collects what this machine knows of those that do not answer.
#pragma once

#include <hive/application.hpp>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace hive::explaining {

/// Drones that do not answer.
struct Absent {
    std::vector<CrashedDrone> crashed;
    std::vector<FailedDrone> failed;
    std::map<std::string, std::int64_t> suspended;  ///< process, by drone
    std::map<std::string, std::int64_t> starting;   ///< process that has the name, but is not reachable yet
    std::map<std::string, std::string> kinds;       ///< by drone, for those that can be started here
    std::set<std::string> remembered;               ///< whose saved state is on this machine
    std::map<std::string, std::string> ssh;         ///< how to reach other machines, by host of an address
    std::map<std::string, std::int64_t> processes;  ///< that hold the name, by drone

    /// Reads the facts about a drone of this machine.
    void add(Application& application, const std::string& drone);
    /// Reads the machines that are reachable over ssh.
    void add_machines(Application& application);
};

struct Look {
    std::vector<StatusAnswer> answers;
    /// By drone of this machine that does not answer: its senders, from its saved state.
    std::map<std::string, std::vector<std::string>> saved_senders;

    /// By the name that the application uses, or by the drone's own name if that is unique.
    [[nodiscard]] const StatusAnswer* find(const std::string& drone) const;
};

/// One answer for each of the drones, in their order.
using Ask = std::function<std::vector<StatusAnswer>(const std::vector<std::string>&)>;
Ask status_by(Application& application);

/// Queries the drones, their senders up to the sources, and the receivers for which these wait.
Look look_from(Application& application, const std::vector<std::string>& drones, const Ask& ask);

bool is_elsewhere(const Place& place);
/// Edges for which an output waits: of a group, its connected members, or those that it lost if none is connected.
std::vector<const EdgeStatus*> awaited(const OutputStatus& output);

}  // namespace hive::explaining
