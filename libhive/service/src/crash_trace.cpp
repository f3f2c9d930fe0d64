// The handler only forks and waits: work that may hang or fail with corrupted memory runs in the child, which has a
// deadline. Names and lines come from eu-addr2line of elfutils, in a new process with a sound heap.
#include "crash_trace.hpp"

#include "crash_frames.hpp"

#include <hive/embedded_drone.hpp>
#include <hive/platform/crash_signals.hpp>

#include <algorithm>
#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <execinfo.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hive::service {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#elif defined(__has_feature)
constexpr bool sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool sanitized = false;
#endif

constexpr int limit_of_names_ms = 4000, limit_of_addresses_ms = 1000;

/// Everything for the handler is prepared before the crash, since it must not allocate.
struct Crash {
    char note[4096] = "";           ///< the path
    std::atomic<int> foreign = -1;  ///< a memory file; negative: none
    int signal = 0;
    long long time_us = 0;
    pid_t process = 0, thread = 0;
    Frames frames;
    Frame cause;
    char text[64 * 1024] = "";
};
Crash crash;
std::atomic_flag crashing;
bool tracing = false;

void write_all(int to, const char* text, std::size_t size)
{
    for (ssize_t written = 0; size > 0; text += written, size -= static_cast<std::size_t>(written))
        if ((written = ::write(to, text, size)) <= 0)
            return;  // no way to report it
}

__attribute__((format(printf, 2, 3))) void print(int to, const char* format, ...)
{
    static char line[8192];
    va_list values;
    va_start(values, format);
    const int size = std::vsnprintf(line, sizeof line, format, values);
    va_end(values);
    write_all(to, line, std::min(sizeof line - 1, static_cast<std::size_t>(std::max(0, size))));
}

const char* name_of(int signal)
{
    switch (signal) {
    case SIGSEGV: return "SIGSEGV";
    case SIGBUS: return "SIGBUS";
    case SIGILL: return "SIGILL";
    case SIGFPE: return "SIGFPE";
    default: return "SIGABRT";
    }
}

/// A text within a JSON string; other characters that need escaping do not occur in names.
void print_escaped(int to, const char* text)
{
    for (; *text != '\0'; ++text) {
        const char escaped[2] = {'\\', *text};
        if (*text == '"' || *text == '\\')
            write_all(to, escaped, 2);
        else
            write_all(to, static_cast<unsigned char>(*text) < ' ' ? " " : text, 1);
    }
}

void write_note()
{
    const int note = ::open(crash.note, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK,
                            0600);  // a FIFO must not block it
    if (note < 0)
        return;
    print(note, R"({"pid":%d,"signal":"%s","time_us":%lld)", static_cast<int>(crash.process), name_of(crash.signal),
          crash.time_us);
    for (const auto& [key, value] :
         {std::pair("function", crash.cause.function), std::pair("source", crash.cause.source)})
        if (*value != '\0') {
            print(note, ",\"%s\":\"", key);
            print_escaped(note, value);
            write_all(note, "\"", 1);
        }
    write_all(note, "}\n", 2);
    ::close(note);
}

/// The frames that the runtime of another language has written.
void repeat_foreign()
{
    if (crash.foreign < 0)
        return;
    const auto size = ::pread(crash.foreign, crash.text, sizeof crash.text - 1, 0);
    crash.text[std::max<ssize_t>(size, 0)] = '\0';
    write_all(STDERR_FILENO, crash.text, std::strlen(crash.text));
    crash.cause = foreign_cause(crash.text);
}

/// Runs the work in a child with a time limit. @return whether the work succeeded
bool in_child(bool (*work)(), int limit_ms)
{
    const pid_t child = ::_Fork();
    if (child == 0) {
        for (const int signal : platform::crash_signals)
            ::signal(signal, SIG_DFL);
        ::close_range(STDERR_FILENO + 1, ~0U, 0);  // peers see that the drone is gone, even if the child hangs
        ::_exit(work() ? 0 : 1);
    }
    int status = 0;
    for (int waited_ms = 0; child > 0 && waited_ms < limit_ms; ++waited_ms) {
        if (::waitpid(child, &status, WNOHANG) != 0)
            return status == 0;
        const timespec millisecond{0, 1'000'000};
        ::nanosleep(&millisecond, nullptr);
    }
    if (child > 0) {
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
    }
    return false;
}

[[noreturn]] void become_addr2line(int out)
{
    static char process[16], addresses[Frames::most][24];
    const char* words[Frames::most + 8] = {"eu-addr2line", "-fCi", "--pretty-print", "-p", process};
    std::snprintf(process, sizeof process, "%d", static_cast<int>(crash.process));
    for (int i = 0; i < crash.frames.count; ++i) {
        std::snprintf(addresses[i], sizeof addresses[i], "%p", crash.frames.shown(i));
        words[5 + i] = addresses[i];
    }
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::unsetenv("DEBUGINFOD_URLS");  // a crash must not wait for a server
    const int nowhere = ::open("/dev/null", O_RDWR);
    ::dup2(nowhere, STDIN_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    ::dup2(out, STDOUT_FILENO);
    ::execvp(words[0], const_cast<char* const*>(words));
    ::_exit(127);
}

/// Writes the frames as named by addr2line; false: it is not installed.
bool ask_addr2line()
{
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0)
        return false;
    if (::_Fork() == 0)
        become_addr2line(ends[1]);
    ::close(ends[1]);
    std::size_t size = 0;
    for (ssize_t more = 1; more > 0 && size < sizeof crash.text - 1;
         size += static_cast<std::size_t>(std::max<ssize_t>(more, 0)))
        more = ::read(ends[0], crash.text + size, sizeof crash.text - 1 - size);
    crash.text[size] = '\0';
    return size > 0;
}

void walk()
{
    if (crash.frames.count == 0)
        crash.frames.walk();
}

bool explain()
{
    walk();
    if (!ask_addr2line())
        return false;
    Explained explained(crash.frames, crash.text);
    for (int i = 0; explained.next(); ++i)
        print(STDERR_FILENO, "  #%-2d %s%s%s\n", i, explained.frame().function, *explained.frame().source ? " at " : "",
              explained.frame().source);
    if (*crash.cause.function == '\0')
        crash.cause = explained.cause();
    write_note();
    return true;
}

/// Without eu-addr2line: writes exported symbols.
bool list_addresses()
{
    walk();
    ::backtrace_symbols_fd(crash.frames.addresses, crash.frames.count, STDERR_FILENO);
    if (*crash.cause.function == '\0')
        crash.cause = exported_cause(crash.frames);
    write_note();
    return true;
}

void die(int signal)
{
    ::signal(signal, SIG_DFL);
    ::raise(signal);
    sigset_t only;
    ::sigemptyset(&only);
    ::sigaddset(&only, signal);
    ::pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
}

void on_crash(int signal, siginfo_t* info, void* /*context*/)
{
    if (crashing.test_and_set()) {
        if (crash.thread != ::gettid())  // the other thread kills the process
            ::sleep((limit_of_names_ms + limit_of_addresses_ms) / 1000 + 1);
        return die(signal);
    }
    crash.thread = ::gettid();
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    crash.time_us = now.tv_sec * 1'000'000LL + now.tv_nsec / 1000;
    crash.signal = signal;
    crash.process = ::getpid();
    if (info->si_code > 0 && signal != SIGABRT)
        print(STDERR_FILENO, "crashed: %s at address %p\n", name_of(signal), info->si_addr);
    else
        print(STDERR_FILENO, "crashed: %s\n", name_of(signal));
    repeat_foreign();
    write_note();
    if (!in_child(explain, limit_of_names_ms))
        in_child(list_addresses, limit_of_addresses_ms);
    die(signal);
}

bool handle(int signal)
{
    struct sigaction present {};
    if (::sigaction(signal, nullptr, &present) != 0 || (present.sa_flags & SA_SIGINFO) != 0
        || present.sa_handler != SIG_DFL)
        return false;
    struct sigaction ours {};
    ours.sa_sigaction = on_crash;
    ours.sa_flags = SA_SIGINFO | SA_ONSTACK;
    ::sigfillset(&ours.sa_mask);
    for (const int other : platform::crash_signals)
        ::sigdelset(&ours.sa_mask, other);
    ::sigaddset(&ours.sa_mask, signal);
    return ::sigaction(signal, &ours, nullptr) == 0;
}

}  // namespace

void trace_crashes(const std::filesystem::path& note)
{
    if (sanitized || *crash.note != '\0' || note.native().size() >= sizeof crash.note)
        return;
    std::strcpy(crash.note, note.c_str());
    static const platform::CrashStack stack;
    for (const int signal : platform::crash_signals)
        tracing = handle(signal) || tracing;
}

}  // namespace hive::service

namespace hive {

int foreign_stack_descriptor() noexcept
{
    using service::crash;
    if (service::tracing && crash.foreign < 0)
        crash.foreign = ::memfd_create("crash", MFD_CLOEXEC);
    return crash.foreign < 0 ? STDERR_FILENO : crash.foreign.load();
}

}  // namespace hive
