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
    void look_after_the_fallen(const SwarmWatch& watch);
    [[nodiscard]] std::vector<std::string> fallen() const;
    void give_up(const std::string& drone);
    void start(const std::vector<std::string>& drones, const SwarmWatch& watch);
    /// Gives those that were started again the values and connections that they do not remember.
    void settle();
    void tell_trouble(const std::string& text);

    Application& application_;
    const SwarmPlan& plan_;
    std::function<void(const std::string& text)> told_;
    std::map<std::string, RestartLimit> limits_;
    std::set<std::string> given_up_, unsettled_;
    Clock::time_point settle_at_{};
    std::string trouble_;
};

}  // namespace hive::swarm
