// Prints incoming lines until a count or an end is reached.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace hivectl {

struct PrintUntil {
    std::string verb;                                       ///< for messages
    std::int64_t count = 0;                                 ///< lines; 0: unlimited
    std::optional<std::chrono::milliseconds> timeout = {};  ///< give up after this long without a line; empty: never
    std::function<std::string()> reason = {};  ///< called when nothing arrives: the likely cause, or a command
    /// Called when nothing arrives: the missing events, if everything has ended. Empty: continue anyway.
    std::function<std::optional<std::string>()> ended = {};
    std::string what = {};  ///< for the status line: the kind of lines
    /// Called once per silence of a few seconds.
    std::function<void()> silence = {};
};

/// The exit code of a verb whose sources have ended; prints what is missing on stderr.
int exit_code_at_end(const std::string& verb, const std::string& text);

/// Prints the lines of `next`, which blocks at most the given time, until the count, Ctrl-C or the end of all sources.
/// Returns the exit code.
int print_lines(const PrintUntil& until,
                const std::function<std::optional<std::string>(std::chrono::milliseconds)>& next);

}  // namespace hivectl
