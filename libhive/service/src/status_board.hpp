// What everybody may know of a drone while its code is busy: its state, its counts, its last exception.
#pragma once

#include "declaration.hpp"

#include <hive/event/clock.hpp>

#include <atomic>
#include <mutex>

namespace hive::service {

/// Any thread. Its mutex is locked by its own small functions and by nobody else.
class StatusBoard {
public:
    /// A copy of what the board says at one moment.
    struct Values {
        State state = State::starting;
        std::string condition;
        std::string callback;  ///< what the user thread works on
        ExceptionPolicy policy{};
        std::int64_t busy_us = 0;
        event::Clock::time_point busy_since{};
        std::int64_t received = 0, processed = 0, abandoned = 0, duplicates = 0, discarded = 0, dropped = 0;
        std::map<std::string, std::int64_t> abandoned_at;  ///< by input
        Json last_exception;
        std::vector<MatchCounts> matched;  ///< one for each matching, in the order of their declaration
    };
    [[nodiscard]] Values values() const;

    // --- the state ---
    [[nodiscard]] bool halted() const noexcept { return halted_; }
    [[nodiscard]] bool stopping() const noexcept { return stopping_; }
    void idle();
    void halt();
    /// @param discarded  events that the drone leaves out to continue with the newest
    void resume(std::size_t discarded);
    /// @return  whether this was the first call
    bool stop();
    /// The loop has ended.
    void ended();

    // --- the work ---
    void begin_work(const std::string& callback);
    void end_work();
    void processed(const Set& set);
    void abandoned(const Set& set);
    void matched(std::size_t matching, MatchCounts counts);

    // --- what arrives ---
    /// @param fresh  false: an answer that had come before
    /// @param dropped  events that went for this one because the queue was full
    void arrived(bool fresh, std::size_t dropped);

    // --- what is told ---
    /// @return  whether that is news
    bool condition(const std::string& text);
    void exception(Json description);
    [[nodiscard]] ExceptionPolicy policy() const;
    void policy(ExceptionPolicy policy);

private:
    std::atomic<bool> halted_ = false, stopping_ = false;
    mutable std::mutex mutex_;
    Values values_;
};

}  // namespace hive::service
