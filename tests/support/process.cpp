// Fork, exec, and a descriptor that signals the child's exit.
#include "process.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <poll.h>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace hive::test {
namespace fs = std::filesystem;
namespace {

std::vector<char*> pointers(const std::vector<std::string>& texts)
{
    std::vector<char*> result;
    for (const auto& text : texts)
        result.push_back(const_cast<char*>(text.c_str()));
    result.push_back(nullptr);
    return result;
}

std::vector<std::string> environment_with(std::vector<std::string> extra)
{
    const auto name_of = [](const std::string& variable) { return variable.substr(0, variable.find('=')); };
    const std::size_t replaced = extra.size();
    for (char** variable = environ; *variable; ++variable) {
        bool known = false;
        for (std::size_t i = 0; i < replaced; ++i)
            known = known || name_of(extra[i]) == name_of(*variable);
        if (!known)
            extra.emplace_back(*variable);
    }
    return extra;
}

int open_log(const fs::path& file)
{
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (descriptor < 0)
        throw std::runtime_error("cannot open " + file.string() + ": " + std::strerror(errno));
    return descriptor;
}

/// Blocks signals around a fork: a child that still has the handlers of the test could wait forever in one, for a lock
/// that another thread of the test had.
class SignalsBlocked {
public:
    SignalsBlocked()
    {
        sigset_t all;
        ::sigfillset(&all);
        ::pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    ~SignalsBlocked() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    SignalsBlocked(const SignalsBlocked&) = delete;
    SignalsBlocked& operator=(const SignalsBlocked&) = delete;
    [[nodiscard]] const sigset_t& before() const { return before_; }

private:
    sigset_t before_;
};

/// Calls only functions that are safe between fork and exec in a process with threads.
[[noreturn]] void become(char* const* words, char* const* environment, int out, int err, const sigset_t& signals)
{
    for (const int handled : {SIGINT, SIGTERM, SIGHUP})
        ::signal(handled, SIG_DFL);
    ::pthread_sigmask(SIG_SETMASK, &signals, nullptr);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int null = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::dup2(null, STDIN_FILENO);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    ::execve(words[0], words, environment);
    ::_exit(127);
}

/// @param watch  the pidfd; -1 under valgrind, which does not know pidfd_open: then it looks every 10 ms
bool exits_within(pid_t pid, int watch, Milliseconds timeout)
{
    pollfd ended{watch, POLLIN, 0};
    const auto end = Clock::now() + timeout;
    for (auto left = timeout;; left = std::chrono::duration_cast<Milliseconds>(end - Clock::now())) {
        const auto step = std::max(Milliseconds(0), watch >= 0 ? left : std::min(left, Milliseconds(10)));
        if (::poll(&ended, 1, static_cast<int>(step.count())) > 0)
            return true;
        siginfo_t exited{};
        if (watch < 0 && ::waitid(P_PID, static_cast<id_t>(pid), &exited, WEXITED | WNOHANG | WNOWAIT) == 0
            && exited.si_pid == pid)
            return true;
        if (Clock::now() >= end)
            return false;
    }
}

}  // namespace

Process::Process(const std::vector<std::string>& words, const std::vector<std::string>& environment,
                 const fs::path& log)
    : Process(words, environment, log, log)
{
}

Process::Process(const std::vector<std::string>& words, const std::vector<std::string>& environment,
                 const fs::path& out, const fs::path& err)
{
    const auto variables = environment_with(environment);
    const auto word_pointers = pointers(words), variable_pointers = pointers(variables);
    const int out_file = open_log(out), err_file = open_log(err);
    const SignalsBlocked blocked;
    pid_ = ::fork();
    if (pid_ == 0)
        become(word_pointers.data(), variable_pointers.data(), out_file, err_file, blocked.before());
    ::close(out_file);
    ::close(err_file);
    if (pid_ < 0)
        throw std::runtime_error(std::string("cannot fork: ") + std::strerror(errno));
    watch_ = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
}

Process::Process(pid_t pid) : pid_(pid), watch_(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0))) {}

Process Process::adopted(pid_t pid)
{
    siginfo_t exited{};
    if (::waitid(P_PID, static_cast<id_t>(pid), &exited, WEXITED | WNOHANG | WNOWAIT) != 0)
        throw std::runtime_error("process " + std::to_string(pid) + " is no child of this one");
    return Process(pid);
}

Process::~Process()
{
    kill();
    if (watch_ >= 0)
        ::close(watch_);
}

Process::Process(Process&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      watch_(std::exchange(other.watch_, -1)),
      exit_code_(std::exchange(other.exit_code_, std::nullopt))
{
}

Process& Process::operator=(Process&& other) noexcept
{
    std::swap(pid_, other.pid_);
    std::swap(watch_, other.watch_);
    std::swap(exit_code_, other.exit_code_);
    return *this;
}

void Process::signal(int number) const
{
    if (pid_ > 0 && !exit_code_)
        ::kill(pid_, number);  // not reaped yet, so the id is still its own
}

std::optional<int> Process::wait(Milliseconds timeout)
{
    if (pid_ <= 0 || exit_code_)
        return exit_code_;
    if (!exits_within(pid_, watch_, timeout))
        return std::nullopt;
    // It has exited, but if it was killed while its leak check held it by ptrace, waitpid returns it a little later.
    int status = 0, reaped = 0;
    while ((reaped = ::waitpid(pid_, &status, 0)) < 0 && errno == EINTR) {
    }
    if (reaped == pid_)
        exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    return exit_code_;
}

void Process::kill()
{
    signal(SIGKILL);
    while (pid_ > 0 && !wait(Milliseconds(1000)))
        signal(SIGKILL);
}

std::size_t resident_bytes(pid_t pid)
{
    std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
    std::size_t all = 0, resident = 0;
    file >> all >> resident;
    return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

std::size_t open_descriptors(pid_t pid)
{
    const fs::directory_iterator all("/proc/" + std::to_string(pid) + "/fd");
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

std::string text_of(const fs::path& file)
{
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();  // a file in /proc may vanish with its process: no exception
    return std::move(text).str();
}

}  // namespace hive::test
