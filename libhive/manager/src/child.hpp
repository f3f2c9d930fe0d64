// One started process: how it begins, a descriptor that tells of its end, and how it is ended.
#pragma once

#include <hive/transport/descriptor.hpp>

#include <chrono>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace hive {

/// What is run, and what it has of ours.
struct ChildProgram {
    std::vector<std::string> words;        ///< the program first; of $PATH, unless there is a slash in it
    std::vector<std::string> environment;  ///< NAME=VALUE on top of ours
    int in = -1, out = 1, err = 2;         ///< our descriptors that it gets; -1: /dev/null. It gets no others
    bool own_session = true;               ///< so that Ctrl-C at our terminal does not reach it
    bool tied = false;                     ///< it gets SIGTERM when the thread that starts it ends
};

/// Not ended with the object, unless that is asked for: reap_background_processes() looks after it then.
class Child {
public:
    using Clock = std::chrono::steady_clock;

    /// Throws Errc::io when it cannot be run.
    explicit Child(const ChildProgram& program);
    ~Child();
    Child(Child&& other) noexcept;
    Child& operator=(Child&& other) noexcept;

    [[nodiscard]] pid_t pid() const { return pid_; }
    /// Readable when it has ended.
    [[nodiscard]] int descriptor() const { return descriptor_.get(); }
    /// The status as of waitpid once it has ended; it is reaped then. Exit code 126 when the program around us has
    /// reaped it: nobody can tell how it ended, which is no success.
    std::optional<int> ended();
    /// Waits for its end. False: it has not ended by then.
    bool await_end(Clock::time_point until);
    /// Asks it to end, then insists at that time; returns when it is reaped.
    void end(Clock::time_point kill_at);

private:
    pid_t pid_ = -1;
    transport::Descriptor descriptor_;  ///< a pidfd
    std::optional<int> status_{};
};

/// The exit code of a status as of waitpid: 128 + signal when it was killed.
int exit_code_of_status(int status);
/// Throws Errc::io unless the error, as of errno, is 0.
/// @param what  was tried: "run ssh"
void require_done(int error, const std::string& what);

}  // namespace hive
