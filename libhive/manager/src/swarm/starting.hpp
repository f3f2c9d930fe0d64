// Starts drones of a plan through their engines, all at once, and waits until each answers.
#pragma once

#include "../engines/engine.hpp"
#include "../inquiry.hpp"

#include <hive/swarm.hpp>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace hive::swarm {

class Starting {
public:
    Starting(Application& application, const SwarmPlan& plan);

    /// Queues these drones; poll() starts them.
    void begin(const std::vector<std::string>& drones, std::chrono::milliseconds timeout);
    /// Does not block. Returns failures since the last call, in time or late.
    std::vector<SwarmFailure> poll(const SwarmWatch& watch = {});
    /// All that were started.
    [[nodiscard]] const std::set<std::string>& begun() const noexcept { return begun_; }
    /// Those that are neither ready nor failed.
    [[nodiscard]] const std::set<std::string>& waiting() const noexcept { return waiting_; }

    /// Returns when all are ready, or at the first failure.
    std::vector<SwarmFailure> run(const std::vector<std::string>& drones, std::chrono::milliseconds timeout,
                                  const SwarmWatch& watch);
    /// Until something may have changed, at most 10 ms.
    void wait();
    /// Stops the drones that were started, at most 2 s after their deadline to be ready. Returns those that cannot be
    /// stopped.
    std::vector<SwarmFailure> undo() { return undo(std::max(end_, event::Clock::now()) + std::chrono::seconds(2)); }
    std::vector<SwarmFailure> undo(event::Clock::time_point until);

private:
    Engine& engine_of(const SwarmDrone& drone);
    void forget_places(const std::set<std::string>& drones);
    void hear_engines();
    void look_who_is_ready(const SwarmWatch& watch);
    void hear(const StatusAnswer& answer, const SwarmWatch& watch);
    [[nodiscard]] Error not_ready_in_time(const std::string& drone) const;
    void failed(std::string drone,
                const Error& error);  // by value: the argument may be an element of the sets that it is removed from

    Application& application_;
    const SwarmPlan& plan_;
    std::map<std::string, std::unique_ptr<Engine>> engines_;  ///< by host
    std::set<std::string> begun_;                             ///< all
    std::set<std::string> placed_;                            ///< of those: placed, but not known to be ready
    std::set<std::string> waiting_;                           ///< of begun_: neither ready nor failed
    std::map<std::string, Place> places_;                     ///< of drones elsewhere that were started here
    std::map<std::string, Error> last_errors_;                ///< why those in placed_ do not answer
    Inquiry inquiry_;
    event::Clock::time_point end_{};
    std::vector<SwarmFailure> failures_;
};

}  // namespace hive::swarm
