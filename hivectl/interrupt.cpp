// The handler of SIGINT, SIGTERM and SIGHUP.
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
std::atomic<int> deferred{0};  // how many Deferred live
std::atomic<bool> pressed{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void on_signal(int signal)
{
    if (deferred == 0 || pressed.exchange(true))
        ::_exit(128 + signal);
}
static_assert(exit_code::interrupted == 128 + SIGINT);

}  // namespace

void install()
{
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction previous{};
        if (::sigaction(signal, nullptr, &previous) == 0 && previous.sa_handler == SIG_IGN)
            continue;
        struct sigaction action{};
        action.sa_handler = on_signal;
        action.sa_flags = SA_RESTART;
        ::sigaction(signal, &action, nullptr);
    }
}

Deferred::Deferred() { ++deferred; }
Deferred::~Deferred() { --deferred; }

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
