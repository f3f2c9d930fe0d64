// Brings a swarm up as its plan says, takes it down, and writes the running one as a plan.
#pragma once

#include <hive/swarm_plan.hpp>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace hive {

/// One difference between what runs and what the plan says, and so one thing to do.
struct SwarmStep {
    enum class What { start, restart, change, set, connect, disconnect, stop };
    What what = What::start;
    std::string drone;  ///< of a connection: the receiver
    /// set: the parameters, and what they were; restart, change: the same of the fields of an order
    Json values = Json::object(), before = Json::object();
    SwarmConnection connection{};                 ///< connect, disconnect
    std::optional<ConnectionOptions> replaced{};  ///< connect: what the connection had been made with
};
/// "start", "set" ...
std::string_view token(SwarmStep::What what) noexcept;
/// What the step is about, without the verb: "face-1 on gpu1", "face-1 scale=1.05", "camera -> face-1".
std::string to_text(const SwarmStep& step);

/// What a drone of the swarm failed at.
struct SwarmFailure {
    std::string drone;
    Error error;
};

/// What came of bringing a swarm up, or of taking it down.
struct SwarmOutcome {
    std::vector<SwarmStep> steps;        ///< what was done; of what failed, what would have been
    std::vector<SwarmFailure> failures;  ///< empty: all is done
    std::vector<SwarmFailure> remains;   ///< what could not be undone; without failures, what could not be ended
};

/// How the caller goes along with work that takes a while.
struct SwarmWatch {
    std::function<void(std::size_t done, std::size_t all, const std::string& what)> on_progress{};
    std::function<bool()> cancelled{};                    ///< asked often; true: what was begun is undone
    std::function<void(const std::string& text)> told{};  ///< hears what it waits for, as a sentence
    /// Called often, with the drones that are not ready yet, or that still run.
    std::function<void(const std::vector<std::string>& drones)> on_waiting{};
};

/// The drones that belong together by the name of their swarm. A drone knows the swarm that brought it up
/// (Status::swarm), and only that one ends it. A home remembers, in NAME.swarm, the plan that was brought up last, so
/// what a changed plan no longer has is ended. For the thread of its application. Everything throws
/// hive::Error.
class Swarm {
public:
    Swarm(Application& application, SwarmPlan plan);

    /// What up() would do now. Throws Errc::name_taken when a name of the plan belongs to another kind of drone, or to
    /// one on another machine, that this swarm did not have so before; Errc::unreachable when it cannot be told what a
    /// drone is doing.
    /// @param watch  is told of each drone that is used as it was found, see up()
    std::vector<SwarmStep> differences(const SwarmWatch& watch = {});
    /// Starts what does not run and waits until it answers, restarts drones that only a new process can have as the
    /// plan says, then changes, sets, connects, disconnects and stops what differs: everything, or (after a failure, or
    /// when cancelled) nothing. Again, it finds nothing to do. A drone of the plan that another swarm brought up, or
    /// none, is connected, and else left as it is unless the plan has `change_if_shared`. One process at a time changes
    /// a swarm: it waits for its turn, and throws Errc::locked when that does not come.
    /// @param patience  for its turn, and then for all drones to be ready
    SwarmOutcome up(std::chrono::milliseconds patience, const SwarmWatch& watch = {});
    /// Ends all drones that this swarm brought up: sources take nothing more, and each drone ends when it has handed on
    /// what it had.
    /// @param patience  for its turn, as up(), and then for events on their way; then they are lost
    SwarmOutcome down(std::chrono::milliseconds patience, const SwarmWatch& watch = {});

    /// Restarts drones that crash, or do not answer for 10 s on this machine, and whose plan says so: after 0.1 s, then
    /// after pauses that grow up to 30 s, until they come back. One that has crashed 6 times in a row is in
    /// Application::failed() while it does not run. No drone holds up another one. What down() ended, or an up() that
    /// has it no more, stays down until it is brought up again; neither has to wait for a drone of this machine that is
    /// just being started again. One on another machine is ready first, or given up after 62 s. Returns when `watch`
    /// says that it is cancelled; the swarm goes on.
    /// @param told  hears what happened, as a sentence
    void stay(const std::function<void(const std::string& text)>& told, const SwarmWatch& watch);

    [[nodiscard]] const SwarmPlan& plan() const noexcept { return plan_; }
    /// The swarms that were brought up from this home: the plan of each.
    static std::vector<SwarmPlan> remembered(Application& application);
    /// What runs, as a plan. `up` of it changes nothing, and where nothing runs it makes the same swarm.
    /// @param drones  of these; what they receive from others is left out
    static SwarmPlan running(Application& application, const std::string& name, const std::vector<std::string>& drones);

private:
    Application& application_;
    SwarmPlan plan_;
};

}  // namespace hive
