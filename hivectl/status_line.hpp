// One line on stderr, on a terminal only, that says what is going on and erases itself.
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
/// Is stderr a terminal that can erase? Otherwise nothing is ever shown.
bool possible();
/// Shows the text in place of what is shown, shortened to the terminal.
void show(std::string_view text);
/// The verb prints or says what it waits for: the line of a first Waiting goes, and stays away.
void take_over() noexcept;
/// Safe in a signal handler.
void erase() noexcept;
/// While one lives, something else is printed: the line is erased, and not shown again meanwhile.
class Interruption {
public:
    Interruption();

private:
    std::lock_guard<std::mutex> lock_;
};
}  // namespace status_line

/// "camera, face and 3 more"; of none: "the swarm".
std::string names_text(const std::vector<std::string>& names);

/// While one lives: after a second, what is waited for and since when.
class Waiting {
public:
    enum class Turn { first, own };
    /// @param what  follows "waiting for"; empty: nothing is shown
    /// @param turn  first: only until something else is shown or printed
    explicit Waiting(std::string what, Turn turn = Turn::own);
    ~Waiting();
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;

    /// It is still waiting, but for something else.
    void now_for(std::string what);
    /// What was waited for has come: it is waiting since now.
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
    std::jthread thread_;  ///< since the calls that wait do not return meanwhile
};

}  // namespace hivectl
