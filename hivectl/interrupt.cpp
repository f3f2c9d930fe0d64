// The SIGINT handler.
#include "interrupt.hpp"

#include "exit_code.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <thread>
#include <unistd.h>

namespace hivectl::interrupt {
namespace {

// Read and written in a signal handler: lock-free, and nothing else.
std::atomic<bool> deferred{false};
std::atomic<bool> pressed{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void on_interrupt(int)
{
    if (!deferred || pressed.exchange(true))
        ::_exit(exit_code::interrupted);
}

}  // namespace

void install()
{
    struct sigaction previous{};
    if (::sigaction(SIGINT, nullptr, &previous) == 0 && previous.sa_handler == SIG_IGN)
        return;
    struct sigaction action{};
    action.sa_handler = on_interrupt;
    action.sa_flags = SA_RESTART;
    ::sigaction(SIGINT, &action, nullptr);
}

Deferred::Deferred() { deferred = true; }
Deferred::~Deferred() { deferred = false; }

bool requested() { return pressed; }

bool sleep(std::chrono::milliseconds duration)
{
    const auto end = std::chrono::steady_clock::now() + duration;
    while (!requested()) {
        const auto left = end - std::chrono::steady_clock::now();
        if (left <= left.zero())
            return true;
        std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(left, std::chrono::milliseconds(50)));
    }
    return false;
}

}  // namespace hivectl::interrupt
