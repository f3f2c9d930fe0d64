// One child process: starts it, signals its exit with a descriptor, and stops it.
#pragma once

#include <hive/platform/clock.hpp>
#include <hive/transport/descriptor.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace hive {

/// The command of a child, and what it inherits.
struct ChildProgram {
    std::vector<std::string> words;        ///< the program first; looked up in $PATH, unless it has a slash
    std::vector<std::string> environment;  ///< NAME=VALUE in addition to ours
    int in = -1, out = 1, err = 2;         ///< descriptors that it inherits, and no others; -1: /dev/null
    bool own_session = true;               ///< so that Ctrl-C at our terminal does not reach it
    bool tied = false;                     ///< it gets SIGTERM when the thread that starts it exits
};

/// By default the process outlives the object; reap_background_processes() then reaps it.
class Child {
public:
    using Clock = platform::SteadyClock;

    /// Throws Errc::io if the program cannot be run.
    explicit Child(const ChildProgram& program);
    ~Child();
    Child(Child&& other) noexcept;
    Child& operator=(Child&& other) noexcept;

    [[nodiscard]] pid_t pid() const { return pid_; }
    /// Is this the process, or one of the session that it leads, such as the child of a wrapper?
    [[nodiscard]] bool leads(std::int64_t pid) const;
    /// A pidfd, readable when it has exited; open from now on, until let_go(). -1: it has exited. Throws Errc::io.
    [[nodiscard]] int descriptor();
    /// Closes the descriptor: who runs a thousand children and waits for none of them needs none.
    void let_go() { descriptor_ = {}; }
    /// The status as of waitpid once it has exited; it is then reaped. Exit code 126 if other code of this process has
    /// reaped it: its status is unknown, and that is not a success.
    std::optional<int> ended();
    /// Waits until it exits. False: not by then.
    bool await_end(Clock::time_point until);
    /// Sends SIGTERM.
    void terminate();
    /// The same, and SIGKILL at that time; returns when it is reaped.
    void end(Clock::time_point kill_at);

private:
    pid_t pid_ = -1;
    transport::Descriptor descriptor_;
    std::optional<int> status_{};
};

/// The exit code of a status as of waitpid: 128 + signal if it was killed.
int exit_code_of_status(int status);
/// Throws Errc::io unless `error`, an errno, is 0.
/// @param what  that failed: "run ssh"
void require_done(int error, const std::string& what);

}  // namespace hive
