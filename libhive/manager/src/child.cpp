// Fork and exec: posix_spawn cannot tie a process to the life of another.
#include "child.hpp"

#include <hive/error.hpp>
#include <hive/process.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <linux/close_range.h>
#include <mutex>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace hive {

using transport::Descriptor;

namespace {

constexpr int unknown_status = 126 << 8;

/// Our environment with some variables replaced: NAME=VALUE.
std::vector<std::string> environment_with(const std::vector<std::string>& replacements)
{
    const auto same_variable = [](const std::string& a, const std::string& b) {
        return a.substr(0, a.find('=')) == b.substr(0, b.find('='));
    };
    const auto is_one_of = [&](const std::string& variable, const auto& all) {
        return std::ranges::any_of(all, [&](const std::string& one) { return same_variable(one, variable); });
    };
    // A service manager's variables for this process alone: a child must not notify in its name.
    const std::vector<std::string> own{"NOTIFY_SOCKET=", "WATCHDOG_USEC=", "WATCHDOG_PID="};
    std::vector<std::string> result = replacements;
    for (char** variable = environ; *variable; ++variable)
        if (!is_one_of(*variable, replacements) && !is_one_of(*variable, own))
            result.emplace_back(*variable);
    return result;
}

/// For exec; valid as long as the texts are.
std::vector<char*> pointers(const std::vector<std::string>& texts)
{
    std::vector<char*> result;
    for (const auto& text : texts)
        result.push_back(const_cast<char*>(text.c_str()));  // exec predates const
    result.push_back(nullptr);
    return result;
}

/// Everything that the child needs, allocated before the fork: afterwards it must not allocate.
struct Beginning {
    const ChildProgram& program;
    char* const* words;
    char* const* variables;
    pid_t parent;
    int report;  ///< receives the errno if the program cannot be run
};

/// Requests SIGTERM for when the thread that forked exits.
void tie_to(pid_t parent)
{
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent)
        ::_exit(0);
}

/// Each is first duplicated above the standard ones, since it may be one of them.
bool set_descriptors(const ChildProgram& program)
{
    const int in = program.in < 0 ? ::open("/dev/null", O_RDONLY) : program.in;
    std::array<int, 3> above{in, program.out, program.err};
    for (int& descriptor : above)
        if ((descriptor = ::fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1)) < 0)
            return false;
    for (std::size_t i = 0; i < above.size(); ++i)
        if (::dup2(above[i], static_cast<int>(i)) < 0)
            return false;
    return ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC) == 0;
}

/// No signal blocked or ignored.
void set_signals()
{
    for (int signal = 1; signal < NSIG; ++signal)
        ::signal(signal, SIG_DFL);
    sigset_t none;
    ::sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// Calls only functions that are safe between fork and exec in a process with threads.
[[noreturn]] void become(const Beginning& beginning)
{
    const auto& [program, words, variables, parent, report] = beginning;
    if (program.tied)
        tie_to(parent);
    if (program.own_session)
        ::setsid();
    set_signals();
    if (set_descriptors(program))
        ::execvpe(words[0], words, variables);
    const int error = errno;
    [[maybe_unused]] const auto written = ::write(report, &error, sizeof error);
    ::_exit(127);
}

/// The child's errno, from a pipe that closes on exec; 0: exec succeeded.
int error_from(int report)
{
    int error = 0;
    while (::read(report, &error, sizeof error) < 0 && errno == EINTR) {
    }
    return error;
}

/// Processes that outlive their object. Never destroyed: the last ones are added while the program exits.
struct LeftAlone {
    std::mutex mutex;
    std::vector<pid_t> pids;
};

LeftAlone& left_alone()
{
    static auto* all = new LeftAlone;
    return *all;
}

}  // namespace

void require_done(int error, const std::string& what)
{
    if (error != 0)
        throw Error(Errc::io, "cannot " + what + ": " + std::strerror(error));
}

void reap_background_processes()
{
    const std::lock_guard lock(left_alone().mutex);
    std::erase_if(left_alone().pids, [](pid_t pid) { return ::waitpid(pid, nullptr, WNOHANG) != 0; });
}

Child::Child(const ChildProgram& program)
{
    const auto variables = environment_with(program.environment);
    const auto word_pointers = pointers(program.words), variable_pointers = pointers(variables);
    std::array<int, 2> ends{};
    require_done(::pipe2(ends.data(), O_CLOEXEC) == 0 ? 0 : errno, "prepare a process");
    const Descriptor exit(ends[0]);
    Descriptor entry(ends[1]);
    const Beginning beginning{program, word_pointers.data(), variable_pointers.data(), ::getpid(), entry.get()};
    reap_background_processes();
    pid_ = ::fork();
    if (pid_ == 0)
        become(beginning);
    require_done(pid_ < 0 ? errno : 0, "run " + program.words[0]);
    entry = Descriptor();
    const int error = error_from(exit.get());
    if (error != 0)
        ::waitpid(pid_, nullptr, 0);
    require_done(error, "run " + program.words[0]);
}

Child::~Child()
{
    if (pid_ <= 0 || status_)
        return;
    const std::lock_guard lock(left_alone().mutex);
    left_alone().pids.push_back(pid_);
}

Child::Child(Child&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), descriptor_(std::move(other.descriptor_)), status_(other.status_)
{
}

Child& Child::operator=(Child&& other) noexcept
{
    std::swap(pid_, other.pid_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(status_, other.status_);
    return *this;
}

int Child::descriptor()
{
    if (!descriptor_ && !ended()) {
        descriptor_ = Descriptor(static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0)));
        require_done(descriptor_ ? 0 : errno, "watch a process");
    }
    return descriptor_.get();
}

std::optional<int> Child::ended()
{
    int status = 0;
    if (const auto reaped = status_ ? 0 : ::waitpid(pid_, &status, WNOHANG); reaped != 0)
        status_ = reaped < 0 ? unknown_status : status;
    return status_;
}

bool Child::await_end(Clock::time_point until)
{
    for (pollfd over{-1, POLLIN, 0}; !ended();) {
        try {
            over.fd = descriptor();
        } catch (const Error&) {
            over.fd = -1;  // out of descriptors; destructors wait here
        }
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
        if (left <= 0)
            return false;
        const std::int64_t most = over.fd < 0 ? 20 : 3'600'000;
        ::poll(&over, 1, static_cast<int>(std::min<std::int64_t>(left, most)));
    }
    return true;
}

bool Child::leads(std::int64_t pid) const { return pid == pid_ || ::getsid(static_cast<pid_t>(pid)) == pid_; }

void Child::terminate()
{
    if (!ended())
        ::kill(pid_, SIGTERM);  // not reaped yet, so the pid is still its own
}

void Child::end(Clock::time_point kill_at)
{
    terminate();
    if (!await_end(kill_at))
        ::kill(pid_, SIGKILL);
    await_end(Clock::time_point::max());
}

int exit_code_of_status(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

}  // namespace hive
