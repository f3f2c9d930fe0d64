// A process with a log instead of a terminal.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace hivectl {

enum class Life {
    own,  ///< goes on when hivectl has ended
    tied  ///< gets SIGTERM when hivectl ends, however it ends
};

class BackgroundProcess {
public:
    /// Starts it in a session of its own. It inherits no descriptor: stdin is /dev/null, stdout and stderr are appended
    /// to `log`. `environment` are NAME=VALUE on top of ours. Throws Errc::io.
    /// For the main thread: a tied one ends with the thread that started it.
    BackgroundProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      const std::vector<std::string>& environment, const std::filesystem::path& log, Life life);

    [[nodiscard]] pid_t pid() const { return pid_; }
    /// The status as of waitpid once it has ended; it is reaped then.
    std::optional<int> ended();
    /// Asks it to end, then insists after a second; returns when it is reaped.
    void end();
    /// The last lines that it wrote, at most `lines`.
    [[nodiscard]] std::string last_words(std::size_t lines) const;

private:
    std::filesystem::path log_;
    std::uintmax_t log_begin_;  // what was in the log before it
    pid_t pid_ = -1;
    std::optional<int> status_;
};

}  // namespace hivectl
