// Brings a swarm up from its plan, takes it down, and exports the running one as a plan.
#pragma once

#include <hive/swarm_plan.hpp>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace hive {

/// One difference between the running swarm and the plan: one step to do.
struct SwarmStep {
    enum class What { start, restart, change, set, connect, disconnect, stop };
    What what = What::start;
    std::string drone;  ///< of a connection: the receiver
    /// set: the new and old parameters; restart, change: the same for the fields of an order
    Json values = Json::object(), before = Json::object();
    SwarmConnection connection{};                 ///< connect, disconnect
    std::optional<ConnectionOptions> replaced{};  ///< connect: the earlier options
};
/// "start", "set" ...
std::string_view token(SwarmStep::What what) noexcept;
/// The object of the step, without the verb: "face-1 on gpu1", "face-1 scale=1.05", "camera -> face-1".
std::string to_text(const SwarmStep& step);

/// A failed step of one drone.
struct SwarmFailure {
    std::string drone;
    Error error;
};

/// Result of bringing a swarm up or taking it down.
struct SwarmOutcome {
    std::vector<SwarmStep> steps;        ///< done; after a failure, those that would have been
    std::vector<SwarmFailure> failures;  ///< empty: all is done
    std::vector<SwarmFailure> remains;   ///< what could not be undone; without failures, what could not be stopped
    std::vector<SwarmFailure> silent{};  ///< drones that do not answer, which up() has not changed
};

/// How the caller follows and cancels long work.
struct SwarmWatch {
    std::function<void(std::size_t done, std::size_t all, const std::string& what)> on_progress{};
    std::function<bool()> cancelled{};                    ///< polled; true: all changes are rolled back
    std::function<void(const std::string& text)> told{};  ///< gets what it waits for, as a sentence
    /// Called repeatedly, with the drones that are not ready yet, or that still run.
    std::function<void(const std::vector<std::string>& drones)> on_waiting{};
};

/// The drones of one swarm. A drone reports the swarm that brought it up (Status::swarm), and only that swarm stops it.
/// NAME.swarm in a home keeps the last plan brought up, so drones that a changed plan no longer has are stopped. For
/// the thread of its application. Every function throws hive::Error.
class Swarm {
public:
    Swarm(Application& application, SwarmPlan plan);

    /// What up() would do now. Throws Errc::name_taken if a name of the plan belongs to a drone of another kind or
    /// machine, unless this swarm had that drone before; Errc::unreachable if a drone refuses to report its state;
    /// Errc::refused if an engine cannot start a drone from here.
    /// @param watch  is notified of each drone that is used unchanged, see up(), or that hangs
    std::vector<SwarmStep> differences(const SwarmWatch& watch = {});
    /// Starts missing drones and waits until they answer, restarts drones if only a new process can match the plan,
    /// then changes, sets, connects, disconnects and stops what differs: all or (after a failure, or when cancelled)
    /// nothing. A second call changes nothing. A drone that does not answer in time does not block the others: it is in
    /// `silent`. A drone of the plan that this swarm did not bring up is connected, and otherwise unchanged unless the
    /// plan has `change_if_shared`. One process at a time changes a swarm: others wait, and throw Errc::locked after
    /// `timeout`.
    /// @param timeout  for the right to change the swarm, and then for all drones to be ready
    SwarmOutcome up(std::chrono::milliseconds timeout, const SwarmWatch& watch = {});
    /// Stops all drones that this swarm brought up: sources first, and each drone once its events are delivered.
    /// @param timeout  for the right to change the swarm, as up(), and then for events in flight; then they are lost
    SwarmOutcome down(std::chrono::milliseconds timeout, const SwarmWatch& watch = {});

    /// Restarts drones that crash, or do not answer for 10 s on this machine, if their plan says so: after 0.1 s, then
    /// after pauses that grow up to 30 s, until they run. One that has crashed 6 times in a row is in
    /// Application::failed() while it is not running. No drone delays another. Drones that down() or a later up()
    /// stopped stay down until they are brought up again. Neither call waits for a drone of this machine that is being
    /// restarted; it does for one on another machine, until that is ready or given up after 62 s. Returns when `watch`
    /// is cancelled; the swarm keeps running.
    /// @param told  gets what happened, as a sentence
    void stay(const std::function<void(const std::string& text)>& told, const SwarmWatch& watch);

    [[nodiscard]] const SwarmPlan& plan() const noexcept { return plan_; }
    /// The swarms that were brought up from this home: the plan of each.
    /// @param unreadable  gets the error of each plan that cannot be read; without it, that is thrown
    static std::vector<SwarmPlan> remembered(Application& application,
                                             const std::function<void(const Error&)>& unreadable = {});
    /// The running swarm as a plan. `up` with this plan changes nothing here, and recreates the swarm elsewhere.
    /// @param drones  only these; their connections from others are omitted
    static SwarmPlan running(Application& application, const std::string& name, const std::vector<std::string>& drones);

private:
    Application& application_;
    SwarmPlan plan_;
};

}  // namespace hive
