// Printing what comes, line by line, until there was enough of it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace hivectl {

struct PrintUntil {
    std::string verb;                                        ///< complaints name it
    std::int64_t count = 0;                                  ///< lines; 0: without end
    std::optional<std::chrono::milliseconds> patience = {};  ///< nothing comes for this long; empty: wait for ever
    std::function<std::string()> reason = {};  ///< asked when nothing comes: what may be the cause, or what to look at
    /// Asked when nothing comes: what is said about the end, if everything has ended. Empty: it goes on all the same.
    std::function<std::optional<std::string>()> ended = {};
    std::string what = {};  ///< for the status line: what comes
    /// Called once in each silence of a few seconds.
    std::function<void()> silence = {};
};

/// The exit code of a verb whose sources have ended; what is lacking is said on stderr.
int exit_code_at_end(const std::string& verb, const std::string& text);

/// Prints the lines that `next` gives, which waits no longer than it is told; until that, or Ctrl-C, or the end of
/// everything. Returns the exit code.
int print_lines(const PrintUntil& until,
                const std::function<std::optional<std::string>(std::chrono::milliseconds)>& next);

}  // namespace hivectl
