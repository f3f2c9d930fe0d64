// Runs other programs to read their output, and describes how processes exited.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace hive {

/// Reaps background processes that have exited and that nothing here waits for; otherwise they would stay zombies while
/// this process lives.
void reap_background_processes();

/// "was killed by signal 9", "ended with exit code 1"; from a status as of waitpid.
std::string how_it_ended(int status);
/// The same for a drone that was not ready yet. If it exited with 0, it may not call run().
std::string how_its_start_ended(int status);

/// The last lines of a log after its first `begin` bytes; empty if there is no log.
std::string last_lines(const std::filesystem::path& log, std::size_t lines, std::uintmax_t begin = 0);

/// Result of a program.
struct CommandResult {
    int exit_code = 0;  ///< 128 + signal when it was killed
    std::string out, err;
    bool late = false;  ///< it was stopped at its timeout
};

/// Runs a program of $PATH with stdin from /dev/null and waits until it exits; it gets SIGTERM at the timeout.
/// `environment` are NAME=VALUE in addition to ours. Throws Errc::io when it cannot be run, Errc::too_large when it
/// prints more than 16 MiB.
/// @param cancelled  polled while it waits; true: as at the timeout
CommandResult run_command(const std::vector<std::string>& words, std::chrono::milliseconds limit,
                          const std::vector<std::string>& environment = {},
                          const std::function<bool()>& cancelled = {});
/// Runs a program of $PATH at our terminal, and returns its exit code.
int run_attached(const std::vector<std::string>& words);

}  // namespace hive
