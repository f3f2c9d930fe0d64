// Ctrl-C, and a terminal that goes away: ends at once with 128 + signal (130), unless a verb has something to put in
// order first.
#pragma once

#include <chrono>

namespace hivectl::interrupt {

/// Installs the handler; leaves signals ignored where the shell wants it so (background jobs of scripts).
void install();
/// While one lives, the first Ctrl-C only makes requested() true; the second still ends at once. What comes within 200
/// ms of the first is no second: timeout(1) signals the process and then its group.
class Deferred {
public:
    Deferred();
    ~Deferred();
    Deferred(const Deferred&) = delete;
    Deferred& operator=(const Deferred&) = delete;
};
/// As a Deferred that lives until the process exits: whatever the verb has done by then decides its exit code.
void defer_until_exit();
bool requested();
/// 128 + the signal that came; 130 if none did.
int exit_code();
/// The process exits with exit_code() after this many seconds, whatever it does then.
void exit_after(unsigned seconds);
/// Sleeps until Ctrl-C; false when it was pressed.
bool sleep(std::chrono::milliseconds duration);

}  // namespace hivectl::interrupt
