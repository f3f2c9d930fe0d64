// Restarts crashed and hanging drones of a swarm, each with pauses of its own.
#pragma once

#include "../inquiry.hpp"
#include "claim.hpp"
#include "record.hpp"
#include "starting.hpp"

#include <hive/swarm.hpp>

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace hive::swarm {

/// How long to wait before a drone is restarted: 0.1 s, and twice as long each time it crashes again within a minute,
/// up to 30 s. Pure logic.
class RestartPause {
public:
    using Clock = std::chrono::steady_clock;

    /// Counts one more crash, and returns when the drone may be started.
    Clock::time_point after_crash(Clock::time_point now);
    /// Call it when the drone is ready.
    void ready(Clock::time_point now) { ready_at_ = now; }
    /// Crashes in a row.
    [[nodiscard]] int crashes() const noexcept { return crashes_; }

private:
    int crashes_ = 0;
    std::optional<Clock::time_point> ready_at_{};
};

/// Changes the swarm only with the claim, as `up` and `down` do, releases the claim to any process that waits for it,
/// and restarts only drones that were brought up and not taken down. Their options are in the plan that was brought up
/// last, possibly by another `up`.
class Staying {
public:
    using Clock = std::chrono::steady_clock;

    /// @param told  gets each event of a drone, and each problem once
    Staying(Application& application, SwarmPlan plan, std::function<void(const std::string& text)> told);

    /// Checks once, and restarts due drones without waiting for them. Does not throw if a drone fails or does not
    /// answer: the next check retries.
    void look();
    /// Waits until the next check is due.
    void wait();

private:
    /// One supervised drone.
    struct Care {
        RestartPause pause{};
        std::optional<Clock::time_point> restart_at{};  ///< set: it has crashed
        std::optional<Clock::time_point> missing_since{}, silent_since{};
        std::shared_ptr<const SwarmPlan> plan{};  ///< with which it is being started
        std::unique_ptr<Starting> starting{};
        bool begun = false;       ///< started, and not ready since
        bool taken_down = false;  ///< reported
        bool shared = false;      ///< another swarm brought it up and decides on its restarts
    };

    void adopt(SwarmPlan plan);
    void read_record();
    [[nodiscard]] bool is_up(const std::string& drone) const;
    void hear(const StatusAnswer& answer, const std::vector<std::string>& remembered);
    void hear_silence(const StatusAnswer& answer, Care& care);
    [[nodiscard]] bool has_crashed(const StatusAnswer& answer, Care& care,
                                   const std::vector<std::string>& remembered) const;
    void crashed(const std::string& drone, Care& care);
    void follow_starts();
    void give_way();
    void start_due();
    /// Gives restarted drones the values and connections that are not in their saved state.
    void settle();
    void log_problem(const std::string& text);
    [[nodiscard]] bool is_starting() const;

    Application& application_;
    Record record_;
    std::string recorded_;                   ///< text of the last record that was read
    std::shared_ptr<const SwarmPlan> plan_;  ///< the last that was brought up
    bool is_up_ = true;                      ///< and not taken down since
    std::function<void(const std::string& text)> told_;
    Inquiry inquiry_;
    Claim claim_;  ///< held while something is being started
    std::map<std::string, Care> cares_;
    std::set<std::string> unsettled_;
    Clock::time_point settle_at_{};
    std::string trouble_;
};

}  // namespace hive::swarm
