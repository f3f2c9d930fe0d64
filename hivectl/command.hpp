// Running another program and reading what it prints.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace hivectl {

/// What a program came to.
struct CommandResult {
    int exit_code = 0;  ///< 128 + signal when it was killed
    std::string out, err;
    bool late = false;  ///< it was ended because its time was over
};

/// Runs a program of $PATH with stdin from /dev/null and waits for its end; it gets SIGTERM when its time is over.
/// Throws Errc::io when it cannot be run, Errc::too_large when it prints more than 16 MiB.
CommandResult run_command(const std::vector<std::string>& words, std::chrono::milliseconds limit);
/// Runs a program of $PATH in our place: it has our terminal, and what it returns is returned.
int run_attached(const std::vector<std::string>& words);

}  // namespace hivectl
