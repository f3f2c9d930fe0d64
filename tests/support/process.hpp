// Child processes that never outlive the test that started them.
#pragma once

#include "eventually.hpp"

#include <sys/types.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hive::test {

/// A child process; ended (SIGKILL, by its id) when this is destroyed. Start it on the test's main thread: it is also
/// killed when the thread that started it ends.
class Process {
public:
    /// Starts `words` with extra environment `NAME=value`; stdout and stderr are appended to `log`.
    Process(const std::vector<std::string>& words, const std::vector<std::string>& environment,
            const std::filesystem::path& log);
    /// As above with stderr in a file of its own.
    Process(const std::vector<std::string>& words, const std::vector<std::string>& environment,
            const std::filesystem::path& out, const std::filesystem::path& err);
    /// A process that a program of this test has left in the background, once this process is its subreaper. Unlike the
    /// others it outlives a test that is killed.
    static Process adopted(pid_t pid);
    ~Process();
    Process(Process&& other) noexcept;
    Process& operator=(Process&& other) noexcept;

    [[nodiscard]] pid_t pid() const noexcept { return pid_; }
    void signal(int number) const;
    /// The exit code (128 + signal if it was killed), if it exits in time.
    std::optional<int> wait(Milliseconds timeout);
    /// SIGKILL; returns when it has exited.
    void kill();

private:
    explicit Process(pid_t pid);

    pid_t pid_ = -1;
    int watch_ = -1;  ///< readable when the process has ended
    std::optional<int> exit_code_;
};

/// Resident memory of a process, bytes.
std::size_t resident_bytes(pid_t pid);
/// Open descriptors of a process.
std::size_t open_descriptors(pid_t pid);
/// The content of a file; empty if there is none.
std::string text_of(const std::filesystem::path& file);
inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
inline std::ptrdiff_t lines_of(const std::string& text) { return std::ranges::count(text, '\n'); }

}  // namespace hive::test
