// Spawn, two pipes, and a deadline.
#include "running_command.hpp"

#include "environment.hpp"

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

namespace hive {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_output = 16 << 20;

void require_done(int error, const std::string& what)
{
    if (error != 0)
        throw Error(Errc::io, "cannot " + what + ": " + std::strerror(error));
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
            throw Error(Errc::too_large, "a command printed more than 16 MiB");
        return size > 0 || (size < 0 && (errno == EINTR || errno == EAGAIN));
    }

private:
    std::array<int, 2> ends_{-1, -1};
};

/// How a child begins.
class Beginning {
public:
    Beginning()
    {
        ::posix_spawn_file_actions_init(&files);
        ::posix_spawnattr_init(&attributes);
    }
    ~Beginning()
    {
        ::posix_spawn_file_actions_destroy(&files);
        ::posix_spawnattr_destroy(&attributes);
    }
    Beginning(const Beginning&) = delete;
    Beginning& operator=(const Beginning&) = delete;

    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
};

pid_t spawn(const std::vector<std::string>& words, const Beginning& beginning,
            const std::vector<std::string>& environment)
{
    const auto variables = environment_with(environment);
    pid_t pid = -1;
    require_done(::posix_spawnp(&pid, words[0].c_str(), &beginning.files, &beginning.attributes, pointers(words).data(),
                                pointers(variables).data()),
                 "run " + words[0]);
    return pid;
}

int exit_code_of_child(pid_t pid)
{
    int status = 0;
    while (::waitpid(pid, &status, 0) < 0)
        if (errno != EINTR)
            return 126;  // where SIGCHLD is ignored nobody can tell how it ended, which is no success
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Ends what it stands for, if that has not been waited for.
class ChildProcess {
public:
    explicit ChildProcess(pid_t pid) : pid_(pid), watch_(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0))) {}
    ~ChildProcess()
    {
        if (pid_ > 0)
            end();
        ::close(watch_);
    }
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;
    [[nodiscard]] int watch() const { return watch_; }  ///< readable when it has ended
    int wait() { return exit_code_of_child(std::exchange(pid_, -1)); }
    /// Asks it to end, and insists after a second.
    int end()
    {
        ::kill(pid_, SIGTERM);
        pollfd ended{watch_, POLLIN, 0};
        if (::poll(&ended, 1, 1000) == 0)
            ::kill(pid_, SIGKILL);
        return wait();
    }

private:
    pid_t pid_;
    int watch_;
};

}  // namespace

struct RunningCommand::Parts {
    Parts(const std::vector<std::string>& words, std::chrono::milliseconds limit,
          const std::vector<std::string>& environment)
        : end(Clock::now() + limit), child(started(words, environment))
    {
        out.close_entry();
        err.close_entry();
        streams = {{{out.exit(), POLLIN, 0}, {err.exit(), POLLIN, 0}, {child.watch(), POLLIN, 0}}};
    }
    /// Reads what is there.
    void read()
    {
        if (streams[0].revents != 0 && !out.read(result.out))
            streams[0].fd = -1;
        if (streams[1].revents != 0 && !err.read(result.err))
            streams[1].fd = -1;
        if (streams[2].revents != 0)
            streams[2].fd = -1;
    }
    /// The end of stderr is not waited for: the connection that an ssh leaves behind may hold it.
    [[nodiscard]] bool ended() const { return streams[0].fd < 0 && streams[2].fd < 0; }
    void read_rest_of_errors()
    {
        for (auto before = std::string::npos; before != result.err.size();) {
            before = result.err.size();
            err.read(result.err);
        }
    }

    Clock::time_point end;
    Pipe out, err;
    ChildProcess child;
    std::array<pollfd, 3> streams{};
    CommandResult result;

private:
    /// In a process group of its own: a Ctrl-C is for the caller, who may need what the command does to undo things.
    pid_t started(const std::vector<std::string>& words, const std::vector<std::string>& environment) const
    {
        Beginning beginning;
        ::posix_spawn_file_actions_addopen(&beginning.files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        ::posix_spawn_file_actions_adddup2(&beginning.files, out.entry(), STDOUT_FILENO);
        ::posix_spawn_file_actions_adddup2(&beginning.files, err.entry(), STDERR_FILENO);
        ::posix_spawnattr_setflags(&beginning.attributes, POSIX_SPAWN_SETPGROUP);
        return spawn(words, beginning, environment);
    }
};

RunningCommand::RunningCommand(const std::vector<std::string>& words, std::chrono::milliseconds limit,
                               const std::vector<std::string>& environment)
    : parts_(std::make_unique<Parts>(words, limit, environment))
{
}

RunningCommand::~RunningCommand() = default;

std::optional<CommandResult> RunningCommand::poll(std::chrono::milliseconds patience)
{
    auto& parts = *parts_;
    for (const auto until = std::min(Clock::now() + patience, parts.end);;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
        const auto ready = ::poll(parts.streams.data(), parts.streams.size(),
                                  static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000)));
        if (ready > 0)
            parts.read();
        if (parts.ended()) {
            parts.read_rest_of_errors();
            parts.result.exit_code = parts.child.wait();
            return std::move(parts.result);
        }
        if (Clock::now() >= parts.end) {
            parts.result.late = true;
            parts.result.exit_code = parts.child.end();
            return std::move(parts.result);
        }
        if (ready <= 0 && left <= 0)
            return std::nullopt;
    }
}

std::vector<int> RunningCommand::descriptors() const
{
    std::vector<int> open;
    for (const auto& stream : parts_->streams)
        if (stream.fd >= 0)
            open.push_back(stream.fd);
    return open;
}

CommandResult run_command(const std::vector<std::string>& words, std::chrono::milliseconds limit,
                          const std::vector<std::string>& environment)
{
    RunningCommand command(words, limit, environment);
    for (;;)
        if (auto result = command.poll(limit))
            return *std::move(result);
}

int run_attached(const std::vector<std::string>& words) { return exit_code_of_child(spawn(words, Beginning(), {})); }

}  // namespace hive
