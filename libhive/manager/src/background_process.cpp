// Fork and exec: posix_spawn cannot tie a process to the life of another.
#include "environment.hpp"

#include <hive/error.hpp>
#include <hive/process.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <linux/close_range.h>
#include <mutex>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace hive {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

void require_started(int error, const std::string& what)
{
    if (error != 0)
        throw Error(Errc::io, "cannot " + what + ": " + std::strerror(error));
}

/// All that the child needs, made before the fork: afterwards it may allocate nothing.
struct Child {
    char* const* words;
    char* const* variables;
    const char* log;
    bool tied;  ///< to the life of the process `parent`
    pid_t parent;
    int report;  ///< takes the errno when the program cannot be run
};

/// SIGTERM when the thread that forked ends, which is the main thread.
void tie_to(pid_t parent)
{
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent)
        ::_exit(0);
}

bool set_descriptors(const char* log)
{
    const int in = ::open("/dev/null", O_RDONLY), out = ::open(log, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW, 0600);
    return in >= 0 && out >= 0 && ::dup2(in, STDIN_FILENO) >= 0 && ::dup2(out, STDOUT_FILENO) >= 0
           && ::dup2(out, STDERR_FILENO) >= 0 && ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC) == 0;
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

/// Only what may be called between fork and exec of a process with threads.
[[noreturn]] void become(const Child& child)
{
    if (child.tied)
        tie_to(child.parent);
    ::setsid();
    set_signals();
    if (set_descriptors(child.log))
        ::execve(child.words[0], child.words, child.variables);
    const int error = errno;
    [[maybe_unused]] const auto written = ::write(child.report, &error, sizeof error);
    ::_exit(127);
}

/// A pipe that closes when the child has become another program, or says why it has not.
class Report {
public:
    Report() { require_started(::pipe2(ends_, O_CLOEXEC) == 0 ? 0 : errno, "prepare a process"); }
    ~Report()
    {
        ::close(ends_[0]);
        close_entry();
    }
    Report(const Report&) = delete;
    Report& operator=(const Report&) = delete;
    [[nodiscard]] int entry() const { return ends_[1]; }
    /// The child's errno, or 0.
    int wait()
    {
        close_entry();
        int error = 0;
        while (::read(ends_[0], &error, sizeof error) < 0 && errno == EINTR) {
        }
        return error;
    }

private:
    void close_entry()
    {
        if (ends_[1] >= 0)
            ::close(std::exchange(ends_[1], -1));
    }

    int ends_[2] = {-1, -1};
};

std::uintmax_t size_or_zero(const fs::path& file)
{
    std::error_code missing;
    const auto size = fs::file_size(file, missing);
    return missing ? 0 : size;
}

/// Processes that go on, and that nobody looks after. Never destroyed: the last ones come when the program ends.
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

BackgroundProcess::Started::~Started()
{
    if (descriptor >= 0)
        ::close(descriptor);
    if (pid <= 0 || status)
        return;
    const std::lock_guard lock(left_alone().mutex);
    left_alone().pids.push_back(pid);
}

void reap_background_processes()
{
    const std::lock_guard lock(left_alone().mutex);
    std::erase_if(left_alone().pids, [](pid_t pid) { return ::waitpid(pid, nullptr, WNOHANG) != 0; });
}

BackgroundProcess::BackgroundProcess(const fs::path& program, const std::vector<std::string>& arguments,
                                     const std::vector<std::string>& environment, const fs::path& log, Life life)
    : log_(log), log_begin_(size_or_zero(log))
{
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const auto variables = environment_with(environment);
    const auto word_pointers = pointers(words), variable_pointers = pointers(variables);
    Report report;
    const Child child{word_pointers.data(), variable_pointers.data(), log.c_str(), life == Life::tied, ::getpid(),
                      report.entry()};
    reap_background_processes();
    const pid_t made = ::fork();
    if (made == 0)
        become(child);
    const int error = made < 0 ? errno : report.wait();
    if (made > 0 && error != 0) {
        ::waitpid(made, nullptr, 0);
    } else if (made > 0) {
        started_->pid = made;
        started_->descriptor = static_cast<int>(::syscall(SYS_pidfd_open, made, 0));
    }
    require_started(error, "run " + program.string() + " with its log in " + log.string());
}

std::optional<int> BackgroundProcess::ended()
{
    int status = 0;
    if (!started_->status && ::waitpid(pid(), &status, WNOHANG) != 0)
        started_->status = status;
    return started_->status;
}

bool BackgroundProcess::await_end(std::chrono::steady_clock::time_point until)
{
    pollfd over{descriptor(), POLLIN, 0};
    while (!ended()) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
        if (left <= 0ms)
            return false;
        ::poll(&over, 1, static_cast<int>(std::min<std::chrono::milliseconds>(left, 1h).count()));
    }
    return true;
}

void BackgroundProcess::end(std::chrono::steady_clock::time_point kill_at)
{
    if (ended())
        return;
    ::kill(pid(), SIGTERM);  // not reaped yet, so the pid is still its own
    if (!await_end(kill_at))
        ::kill(pid(), SIGKILL);
    await_end(std::chrono::steady_clock::time_point::max());
}

std::string BackgroundProcess::last_words(std::size_t lines) const
{
    // A log that is shorter than it was has been cut off by the drone: all of it is of this run.
    return last_lines(log_, lines, log_begin_ <= size_or_zero(log_) ? log_begin_ : 0);
}

std::string how_it_ended(int status)
{
    return WIFSIGNALED(status) ? "was killed by signal " + std::to_string(WTERMSIG(status))
                               : "ended with exit code " + std::to_string(WEXITSTATUS(status));
}

std::string how_its_start_ended(int status)
{
    return how_it_ended(status) + " before it was ready"
           + (status == 0 ? " (the drone must call run(), which returns when it is stopped)" : "");
}

std::string last_lines(const std::filesystem::path& log, std::size_t lines, std::uintmax_t begin)
{
    constexpr std::uintmax_t most = 16 * 1024;
    const auto size = size_or_zero(log);
    std::ifstream file(log, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(std::max(begin, size > most ? size - most : 0)));
    std::vector<std::string> read;
    for (std::string line; std::getline(file, line);)
        read.push_back(line);
    std::string text;
    for (std::size_t i = read.size() > lines ? read.size() - lines : 0; i < read.size(); ++i)
        text += read[i] + "\n";
    return text;
}

}  // namespace hive
