// Takes a swarm down: its own sources first, and each of its drones once its events are delivered.
#pragma once

#include <hive/event/clock.hpp>
#include <hive/swarm.hpp>

#include <chrono>
#include <set>
#include <string>
#include <vector>

namespace hive::swarm {

class Ending {
public:
    Ending(Application& application, const SwarmPlan& plan) : application_(application), plan_(plan) {}

    /// @param timeout  maximum wait for events in flight
    SwarmOutcome run(std::chrono::milliseconds timeout, const SwarmWatch& watch);

private:
    void forget_crashed();
    [[nodiscard]] std::vector<StatusAnswer> ask(const SwarmWatch& watch);
    void stop(const std::vector<std::string>& drones, event::Clock::time_point end);
    void stop_silent(const std::vector<Answer>& silent, event::Clock::time_point end);
    [[nodiscard]] bool is_elsewhere(const std::string& drone) const;
    void ended(const std::string& drone);

    Application& application_;
    const SwarmPlan& plan_;
    SwarmOutcome outcome_{};
    std::set<std::string> left_alone_;  ///< of other swarms
};

}  // namespace hive::swarm
