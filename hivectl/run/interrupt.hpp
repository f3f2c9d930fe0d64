// Ctrl-C and a closed terminal: exits at once with 128 + signal (130), unless a verb must clean up first.
#pragma once

#include <chrono>

namespace hivectl::interrupt {

/// Installs the handler; keeps signals ignored if the shell ignores them (background jobs of scripts).
void install();
/// While one lives, the first Ctrl-C only makes requested() true; the second still exits at once. One within 200 ms of
/// the first does not count: timeout(1) signals the process and then its group.
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
/// 128 + the received signal; 130 without one.
int exit_code();
/// Makes the process exit with exit_code() after this many seconds, whatever it is doing.
void exit_after(unsigned seconds);
/// Sleeps this long, or until Ctrl-C; false if it was pressed.
bool sleep(std::chrono::milliseconds duration);

}  // namespace hivectl::interrupt
