// A process with a log instead of a terminal.
#pragma once

#include "child.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hive {

/// The part of a log that is written from now on.
class LogFromNow {
public:
    LogFromNow(std::filesystem::path file);
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }
    /// The last 15 lines.
    [[nodiscard]] std::string last_lines() const;

private:
    std::filesystem::path file_;
    std::uintmax_t begin_;  ///< its size before
};

class BackgroundProcess : public Child {
public:
    enum class Life {
        own,  ///< keeps running when the process that started it exits
        tied  ///< gets SIGTERM when the process that started it exits for any reason
    };

    /// Starts it in a session of its own. It inherits no descriptor: stdin is /dev/null, stdout and stderr are appended
    /// to `log`. `environment` are NAME=VALUE in addition to ours. Throws Errc::io. A tied one dies with the thread
    /// that started it: use the main thread.
    BackgroundProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      const std::vector<std::string>& environment, LogFromNow log, Life life);

    /// A drone exits within two seconds, whatever its code does.
    void end(Clock::time_point kill_at = Clock::now() + std::chrono::seconds(3)) { Child::end(kill_at); }
    /// The last lines that it wrote.
    [[nodiscard]] std::string last_words() const { return log_.last_lines(); }

private:
    LogFromNow log_;
};

}  // namespace hive
