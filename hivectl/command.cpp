// Spawn, two pipes, and a deadline.
#include "command.hpp"

#include <hive/error.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace hivectl {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_output = 16 << 20;

void require_done(int error, const std::string& what)
{
    if (error != 0)
        throw hive::Error(hive::Errc::io, "cannot " + what + ": " + std::strerror(error));
}

/// One stream of a child, read at this end.
class Pipe {
public:
    Pipe()
    {
        require_done(::pipe2(ends_.data(), O_CLOEXEC) == 0 ? 0 : errno, "make a pipe");
        ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    }
    ~Pipe()
    {
        close_entry();
        ::close(ends_[0]);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    [[nodiscard]] int exit() const { return ends_[0]; }
    [[nodiscard]] int entry() const { return ends_[1]; }
    void close_entry()
    {
        if (ends_[1] >= 0)
            ::close(std::exchange(ends_[1], -1));
    }
    /// What is there; false at the end of the stream.
    bool read(std::string& text) const
    {
        std::array<char, 16 * 1024> buffer;
        const auto size = ::read(ends_[0], buffer.data(), buffer.size());
        if (size > 0)
            text.append(buffer.data(), static_cast<std::size_t>(size));
        if (text.size() > most_output)
            throw hive::Error(hive::Errc::too_large, "a command printed more than 16 MiB");
        return size > 0 || (size < 0 && (errno == EINTR || errno == EAGAIN));
    }

private:
    std::array<int, 2> ends_{-1, -1};
};

class FileActions {
public:
    FileActions() { ::posix_spawn_file_actions_init(&actions_); }
    ~FileActions() { ::posix_spawn_file_actions_destroy(&actions_); }
    FileActions(const FileActions&) = delete;
    FileActions& operator=(const FileActions&) = delete;
    [[nodiscard]] posix_spawn_file_actions_t* get() { return &actions_; }

private:
    posix_spawn_file_actions_t actions_;
};

pid_t spawn(const std::vector<std::string>& words, FileActions& actions)
{
    std::vector<char*> pointers;
    for (const auto& word : words)
        pointers.push_back(const_cast<char*>(word.c_str()));  // the interface of exec is older than const
    pointers.push_back(nullptr);
    pid_t pid = -1;
    require_done(::posix_spawnp(&pid, pointers[0], actions.get(), nullptr, pointers.data(), environ),
                 "run " + words[0]);
    return pid;
}

int exit_code_of_child(pid_t pid)
{
    int status = 0;
    while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Ends what it stands for, if that has not been waited for.
class ChildProcess {
public:
    explicit ChildProcess(pid_t pid) : pid_(pid), watch_(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0))) {}
    ~ChildProcess()
    {
        if (pid_ > 0) {
            terminate();
            exit_code_of_child(pid_);
        }
        ::close(watch_);
    }
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;
    void terminate() const { ::kill(pid_, SIGTERM); }
    [[nodiscard]] int watch() const { return watch_; }  ///< readable when it has ended
    int wait() { return exit_code_of_child(std::exchange(pid_, -1)); }

private:
    pid_t pid_;
    int watch_;
};

/// Reads both until the child and its stdout have ended, or until the deadline; false: that came first. The end of
/// stderr is not waited for: the connection that an ssh leaves behind may hold it.
bool read_both(const ChildProcess& child, const Pipe& out, const Pipe& err, CommandResult& result,
               Clock::time_point deadline)
{
    std::array<pollfd, 3> all{{{out.exit(), POLLIN, 0}, {err.exit(), POLLIN, 0}, {child.watch(), POLLIN, 0}}};
    while (all[0].fd >= 0 || all[2].fd >= 0) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
        if (left <= 0)
            return false;
        ::poll(all.data(), all.size(), static_cast<int>(std::min<std::int64_t>(left, 60'000)));
        if (all[0].revents != 0 && !out.read(result.out))
            all[0].fd = -1;
        if (all[1].revents != 0 && !err.read(result.err))
            all[1].fd = -1;
        if (all[2].revents != 0)
            all[2].fd = -1;
    }
    for (auto before = std::string::npos; before != result.err.size();) {
        before = result.err.size();
        err.read(result.err);
    }
    return true;
}

}  // namespace

CommandResult run_command(const std::vector<std::string>& words, std::chrono::milliseconds limit)
{
    Pipe out, err;
    FileActions actions;
    ::posix_spawn_file_actions_addopen(actions.get(), STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(actions.get(), out.entry(), STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(actions.get(), err.entry(), STDERR_FILENO);
    ChildProcess child(spawn(words, actions));
    out.close_entry();
    err.close_entry();
    CommandResult result;
    result.late = !read_both(child, out, err, result, Clock::now() + limit);
    if (result.late)
        child.terminate();
    result.exit_code = child.wait();
    return result;
}

int run_attached(const std::vector<std::string>& words)
{
    FileActions actions;
    return exit_code_of_child(spawn(words, actions));
}

}  // namespace hivectl
