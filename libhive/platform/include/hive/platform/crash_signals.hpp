// The signals of a crash, which no thread may block; the other signals, which most threads block; and a stack for the
// handler of crashes.
#pragma once

#include <array>
#include <csignal>
#include <sys/mman.h>

namespace hive::platform {

inline constexpr std::array crash_signals{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};

/// Every signal that a thread may leave to others. The kernel kills a thread that blocks the signal of its own crash,
/// and no handler runs.
inline sigset_t signals_for_others() noexcept
{
    sigset_t all;
    sigfillset(&all);
    for (const int signal : crash_signals)
        sigdelset(&all, signal);
    return all;
}

/// Blocks them in the constructing thread while it lives, and for good in threads that are started meanwhile: signals
/// are for the threads that wait for them.
class SignalsBlocked {
public:
    SignalsBlocked() noexcept
    {
        const auto others = signals_for_others();
        ::pthread_sigmask(SIG_SETMASK, &others, &before_);
    }
    ~SignalsBlocked() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    SignalsBlocked(const SignalsBlocked&) = delete;
    SignalsBlocked& operator=(const SignalsBlocked&) = delete;

private:
    sigset_t before_{};
};

/// A stack for the crash handler on the constructing thread, so that the handler also runs when the thread has used up
/// its own stack. It takes no memory before it is used. A thread that has such a stack already keeps it.
class CrashStack {
public:
    CrashStack() noexcept
    {
        stack_t present{};
        if (::sigaltstack(nullptr, &present) != 0 || (present.ss_flags & SS_DISABLE) == 0)
            return;
        void* const memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED)
            return;
        memory_ = memory;
        stack_t ours{};
        ours.ss_sp = memory;
        ours.ss_size = bytes;
        ::sigaltstack(&ours, nullptr);
    }
    ~CrashStack()
    {
        if (!memory_)
            return;
        stack_t present{};
        if (::sigaltstack(nullptr, &present) == 0 && present.ss_sp == memory_) {
            stack_t none{};
            none.ss_flags = SS_DISABLE;
            ::sigaltstack(&none, nullptr);
        }
        ::munmap(memory_, bytes);
    }
    CrashStack(const CrashStack&) = delete;
    CrashStack& operator=(const CrashStack&) = delete;

private:
    static constexpr std::size_t bytes = 128 * 1024;

    void* memory_ = nullptr;
};

}  // namespace hive::platform
