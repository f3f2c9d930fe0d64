// The handler of SIGINT, SIGTERM and SIGHUP.
#include "run/interrupt.hpp"

#include "words/exit_code.hpp"
#include "words/status_line.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace hivectl::interrupt {
namespace {

// Read and written in a signal handler: lock-free, and nothing else.
std::atomic<int> deferred{0};              // number of live Deferred
std::atomic<int> first{0};                 // the first signal
std::atomic<std::int64_t> first_at_ns{0};  // its time
std::atomic<int> wake_up{-1};              // an eventfd, readable from then on
static_assert(std::atomic<std::int64_t>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

constexpr std::int64_t one_press_ns = 200'000'000;

std::int64_t now_ns()
{
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

[[noreturn]] void end_at_once(int signal)
{
    status_line::erase();
    ::_exit(128 + signal);
}

void on_signal(int signal)
{
    const auto now = now_ns();
    std::int64_t earlier = 0;
    if (deferred == 0)
        end_at_once(signal);
    if (first_at_ns.compare_exchange_strong(earlier, now)) {
        first = signal;
        const int error = errno;
        ::eventfd_write(wake_up, 1);
        errno = error;
    } else if (now - earlier > one_press_ns)
        end_at_once(signal);
}
static_assert(exit_code::interrupted == 128 + SIGINT);

}  // namespace

void install()
{
    wake_up = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction previous {};
        if (::sigaction(signal, nullptr, &previous) == 0 && previous.sa_handler == SIG_IGN)
            continue;
        struct sigaction action {};
        action.sa_handler = on_signal;
        action.sa_flags = SA_RESTART;
        ::sigaction(signal, &action, nullptr);
    }
}

Deferred::Deferred() { ++deferred; }
Deferred::~Deferred() { --deferred; }

void defer_until_exit() { ++deferred; }

bool requested() { return first != 0; }
int exit_code() { return 128 + (requested() ? first.load() : SIGINT); }

void exit_after(unsigned seconds)
{
    std::signal(SIGALRM, [](int) { ::_exit(exit_code()); });
    ::alarm(seconds);
}

bool sleep(std::chrono::milliseconds duration)
{
    const auto end = std::chrono::steady_clock::now() + duration;
    while (!requested()) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now()).count();
        if (left <= 0)
            return true;
        pollfd woken{wake_up, POLLIN, 0};
        ::poll(&woken, 1, static_cast<int>(std::min<std::int64_t>(left, 3'600'000)));
    }
    return false;
}

}  // namespace hivectl::interrupt
