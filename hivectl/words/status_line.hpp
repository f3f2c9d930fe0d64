// One line on stderr, only on a terminal, that shows the current activity and is erased afterwards.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace hivectl {

namespace status_line {
/// Is stderr a terminal that can erase? Otherwise the line is never shown.
bool possible();
/// Replaces the line, shortened to the width of the terminal.
void show(std::string_view text);
/// Call it when the verb prints or shows what it waits for: ends the line of a first Waiting for good.
void take_over() noexcept;
/// Safe in a signal handler.
void erase() noexcept;
/// Erases the line during its lifetime, while something else is printed.
class Interruption {
public:
    Interruption();

private:
    std::lock_guard<std::mutex> lock_;
};
}  // namespace status_line

/// "camera, face and 3 more"; for none: "the swarm".
std::string names_text(const std::vector<std::string>& names);

/// During its lifetime, after a second, shows what the verb waits for and how long.
class Waiting {
public:
    enum class Turn { first, own };
    /// @param what  follows "waiting for"; empty: shows nothing
    /// @param turn  first: ends once something else is shown or printed
    explicit Waiting(std::string what, Turn turn = Turn::own);
    ~Waiting();
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;

    /// Changes what it waits for.
    void now_for(std::string what);
    /// Restarts the waiting time: the awaited event has arrived.
    void again();

private:
    using Clock = std::chrono::steady_clock;

    void run(const std::stop_token& end);
    void show();

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::string what_;
    Turn turn_;
    Clock::time_point since_ = Clock::now();
    bool shown_ = false;
    std::jthread thread_;  ///< because the waiting calls block
};

}  // namespace hivectl
