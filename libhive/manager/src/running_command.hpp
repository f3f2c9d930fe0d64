// Reads the output of a program while others run in parallel.
#pragma once

#include <hive/process.hpp>

#include <memory>
#include <optional>

namespace hive {

class RunningCommand {
public:
    /// Runs a program of $PATH with stdin from /dev/null. `environment` are NAME=VALUE in addition to ours. Throws
    /// Errc::io if it cannot be run.
    RunningCommand(const std::vector<std::string>& words, std::chrono::milliseconds limit,
                   const std::vector<std::string>& environment = {});
    /// Stops it: SIGTERM, and SIGKILL after a second.
    ~RunningCommand();
    RunningCommand(const RunningCommand&) = delete;
    RunningCommand& operator=(const RunningCommand&) = delete;

    /// The result, once it has exited or timed out; waits at most this long. Throws Errc::too_large if it prints more
    /// than 16 MiB.
    std::optional<CommandResult> poll(std::chrono::milliseconds timeout = {});
    /// Stops it as at its timeout.
    void end();
    /// One of them is readable when poll() has work.
    [[nodiscard]] std::vector<int> descriptors() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hive
