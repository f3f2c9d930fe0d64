// Runs other programs to read what they print, and says how processes ended.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace hive {

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
/// @param cancelled  asked while it waits; true: the time is over
CommandResult run_command(const std::vector<std::string>& words, std::chrono::milliseconds limit,
                          const std::vector<std::string>& environment = {},
                          const std::function<bool()>& cancelled = {});
/// Runs a program of $PATH in our place: it has our terminal, and what it returns is returned.
int run_attached(const std::vector<std::string>& words);

}  // namespace hive
