// Starts drones of a swarm again that fell, where no service manager does: not too often.
#pragma once

#include <hive/swarm.hpp>

#include <chrono>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace hive::swarm {

class Starting;

/// How often a drone may be started again: 5 times within 60 s. Pure logic.
class RestartLimit {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::size_t most = 5;
    static constexpr std::chrono::seconds within{60};

    /// Counts one more, if it may be.
    bool allows(Clock::time_point now);
    [[nodiscard]] std::size_t counted() const noexcept { return times_.size(); }

private:
    std::deque<Clock::time_point> times_;
};

/// It changes the swarm as `up` and `down` do: only with the claim, which it leaves to whoever waits for that, and only
/// drones that were brought up and not taken down.
class Staying {
public:
    using Clock = std::chrono::steady_clock;

    /// @param told  hears of each drone what happened, and what goes wrong meanwhile, once
    Staying(Application& application, const SwarmPlan& plan, std::function<void(const std::string& text)> told)
        : application_(application), plan_(plan), told_(std::move(told))
    {
    }

    /// Looks once, and starts again what fell. Throws nothing that a drone answers, or fails to: the next look is due.
    void look(const SwarmWatch& watch);

private:
    using Texts = std::vector<std::string>;

    void look_after_the_fallen(const SwarmWatch& watch);
    [[nodiscard]] std::vector<std::string> fallen();
    [[nodiscard]] bool may_be_ending(const StatusAnswer& answer);
    Texts start_what_fell(const SwarmWatch& watch);
    void give_up(const std::string& drone);
    Texts start(const std::vector<std::string>& drones, const SwarmWatch& watch);
    std::vector<SwarmFailure> give_way(Starting& starting, std::vector<SwarmFailure> failures);
    /// Gives those that were started again the values and connections that they do not remember.
    void settle();
    Texts settle_alone();
    void tell_trouble(const std::string& text);

    Application& application_;
    const SwarmPlan& plan_;
    std::function<void(const std::string& text)> told_;
    std::map<std::string, RestartLimit> limits_;
    std::map<std::string, Clock::time_point> missing_since_;  ///< of drones elsewhere
    std::set<std::string> given_up_, taken_down_, unsettled_;
    std::set<std::string> put_off_;  ///< ended before they were ready, for somebody who wanted to change the swarm
    std::set<std::string> shared_;   ///< of other swarms, which start them again or not
    Clock::time_point settle_at_{};
    std::string trouble_;
};

}  // namespace hive::swarm
