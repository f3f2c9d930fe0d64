// A program whose output is read while others run beside it.
#pragma once

#include <hive/process.hpp>

#include <memory>
#include <optional>

namespace hive {

class RunningCommand {
public:
    /// Runs a program of $PATH with stdin from /dev/null. `environment` are NAME=VALUE on top of ours. Throws Errc::io
    /// when it cannot be run.
    RunningCommand(const std::vector<std::string>& words, std::chrono::milliseconds limit,
                   const std::vector<std::string>& environment = {});
    /// Ends it: SIGTERM, and SIGKILL after a second.
    ~RunningCommand();
    RunningCommand(const RunningCommand&) = delete;
    RunningCommand& operator=(const RunningCommand&) = delete;

    /// What it came to, once it has ended or its time is over; waits so long for that. Throws Errc::too_large when it
    /// prints more than 16 MiB.
    std::optional<CommandResult> poll(std::chrono::milliseconds patience = {});
    /// Its time is over.
    void end();
    /// One of them is readable when poll() has something to do.
    [[nodiscard]] std::vector<int> descriptors() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hive
