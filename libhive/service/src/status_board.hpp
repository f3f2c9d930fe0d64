// The drone's status, readable while its code is busy: its state, its condition, its last exception.
#pragma once

#include "declaration.hpp"
#include "durations.hpp"

#include <hive/event/clock.hpp>
#include <hive/status.hpp>

#include <atomic>
#include <map>
#include <mutex>
#include <optional>

namespace hive::service {

/// Any thread. Only its own short functions lock its mutex.
class StatusBoard {
public:
    /// A consistent copy.
    struct Values {
        State state = State::starting;
        std::string condition;
        std::string callback;  ///< the user thread's running callback
        ExceptionPolicy policy{};
        std::string swarm;  ///< that started the drone
        std::int64_t busy_us = 0;
        event::Clock::time_point busy_since{};
        Reason why{};           ///< belongs to the condition
        bool prepared = false;  ///< a set, and so the user thread, waits for its asker's decision
        std::int64_t source_events = 0;
        std::optional<ExceptionStatus> last_exception;
        std::optional<HaltStatus> halted;
        std::vector<MatchCounts> matched;  ///< one per matching, in the order of declaration
    };
    [[nodiscard]] Values values() const;

    // --- the state ---
    [[nodiscard]] bool halted() const noexcept { return halted_; }
    [[nodiscard]] bool stopping() const noexcept { return stopping_; }
    void idle();
    void halt(const std::string& by);
    void resume();
    /// @return  whether this was the first call
    bool stop();
    /// As stop(), for a process that takes over: changes are still saved until handed_over().
    bool hand_over();
    [[nodiscard]] bool handing_over() const noexcept { return handing_over_; }
    void handed_over() { handing_over_ = false; }
    /// The loop has ended.
    void ended();

    // --- the work ---
    void begin_work(const std::string& callback);
    void end_work();
    /// 99 % of the last calls of this callback took at most this long; 0: none yet.
    [[nodiscard]] std::int64_t work_p99_us(const std::string& callback) const;
    void prepared(bool yes);
    void matched(std::size_t matching, MatchCounts counts);

    // --- reports ---
    /// @return whether that is a change
    bool condition(const std::string& text, Reason why);
    void source_events(std::int64_t events);
    void exception(ExceptionStatus exception);
    [[nodiscard]] ExceptionPolicy policy() const;
    void policy(ExceptionPolicy policy);
    void swarm(std::string name);

private:
    std::atomic<bool> halted_ = false, stopping_ = false, handing_over_ = false;
    using DurationsOf = std::map<std::string, Durations>;  ///< by callback

    mutable std::mutex mutex_;
    Values values_;
    DurationsOf durations_;
    DurationsOf::value_type* latest_ = nullptr;  ///< of the last callback: mostly that of the next one, too
};

}  // namespace hive::service
