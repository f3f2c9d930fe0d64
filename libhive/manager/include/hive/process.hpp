// Starting other programs: in the background with a log, or to read what they print.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace hive {

/// A process with a log instead of a terminal.
class BackgroundProcess {
public:
    enum class Life {
        own,  ///< goes on when the one that started it has ended
        tied  ///< gets SIGTERM when the one that started it ends, however it ends
    };

    /// Starts it in a session of its own. It inherits no descriptor: stdin is /dev/null, stdout and stderr are appended
    /// to `log`. `environment` are NAME=VALUE on top of ours. Throws Errc::io.
    /// A tied one ends with the thread that started it: let the main thread do that.
    BackgroundProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      const std::vector<std::string>& environment, const std::filesystem::path& log, Life life);

    [[nodiscard]] pid_t pid() const { return started_->pid; }
    /// The status as of waitpid once it has ended; it is reaped then. 0 when the program around us has reaped it.
    std::optional<int> ended();
    /// Readable when it has ended.
    [[nodiscard]] int descriptor() const { return started_->descriptor; }
    /// Waits for its end. False: it has not ended by then.
    bool await_end(std::chrono::steady_clock::time_point until);
    /// Asks it to end, then insists at that time; returns when it is reaped. A drone ends within two seconds, whatever
    /// its code does.
    void end(std::chrono::steady_clock::time_point kill_at = std::chrono::steady_clock::now()
                                                             + std::chrono::seconds(3));
    /// The last lines that it wrote, at most `lines`.
    [[nodiscard]] std::string last_words(std::size_t lines) const;

private:
    struct Started {
        pid_t pid = -1;
        int descriptor = -1;  ///< a pidfd
        std::optional<int> status{};
        ~Started();
    };

    std::filesystem::path log_;
    std::uintmax_t log_begin_;  // what was in the log before it
    std::shared_ptr<Started> started_ = std::make_shared<Started>();
};

/// Reaps processes in the background that have ended since nobody here looks after them any more: as long as this one
/// lives, they would be shown as defunct.
void reap_background_processes();

/// "was killed by signal 9", "ended with exit code 1"; of a status as of waitpid.
std::string how_it_ended(int status);
/// The same of a drone that was not ready yet. One that ends in good order never ran: run() may be missing.
std::string how_its_start_ended(int status);

/// The last lines of a log behind its first `begin` bytes; empty when there is none.
std::string last_lines(const std::filesystem::path& log, std::size_t lines, std::uintmax_t begin = 0);

/// What a program came to.
struct CommandResult {
    int exit_code = 0;  ///< 128 + signal when it was killed
    std::string out, err;
    bool late = false;  ///< it was ended because its time was over
};

/// Runs a program of $PATH with stdin from /dev/null and waits for its end; it gets SIGTERM when its time is over.
/// `environment` are NAME=VALUE on top of ours. Throws Errc::io when it cannot be run, Errc::too_large when it prints
/// more than 16 MiB.
CommandResult run_command(const std::vector<std::string>& words, std::chrono::milliseconds limit,
                          const std::vector<std::string>& environment = {});
/// Runs a program of $PATH in our place: it has our terminal, and what it returns is returned.
int run_attached(const std::vector<std::string>& words);

}  // namespace hive
