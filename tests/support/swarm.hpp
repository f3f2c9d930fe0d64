// Real processes in a home directory of their own: what the end-to-end tests, the contract suite and the benchmarks stand on.
#pragma once

#include <hive/application.hpp>

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hive::test {

using Milliseconds = std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// What a command came to.
struct Finished {
    int exit_code = -1;  ///< 128 + signal when it was killed
    std::string out, err;
    Milliseconds took{};
};

/// A child process; ended (SIGKILL, by its id) when this is destroyed.
class Process {
public:
    /// Starts `words` with extra environment `NAME=value`; stdout and stderr go to `log`.
    Process(const std::vector<std::string>& words, const std::vector<std::string>& environment, const std::filesystem::path& log);
    ~Process();
    Process(Process&& other) noexcept;
    Process& operator=(Process&& other) noexcept;

    [[nodiscard]] pid_t pid() const noexcept { return pid_; }
    void signal(int number) const;
    /// The exit code, if it ends in time.
    std::optional<int> wait(Milliseconds patience);
    void kill();

private:
    pid_t pid_ = -1;
};

/// A fresh home directory, the built programs, and everything that was started in it; all gone at the end.
class Swarm {
public:
    Swarm();
    ~Swarm();

    [[nodiscard]] const std::filesystem::path& home() const noexcept { return home_; }
    [[nodiscard]] std::filesystem::path program(const std::string& name) const;  ///< "hive-face", "hivectl"
    /// Runs hivectl with a deadline; killed and failed when it passes.
    Finished hivectl(const std::vector<std::string>& words, Milliseconds patience = Milliseconds(15'000)) const;
    /// Starts a drone as a child of the test and returns when it answers; throws with its log when it does not.
    Process drone(const std::string& kind, const std::string& name, const std::vector<std::string>& settings = {},
                  const std::vector<std::string>& more = {}, const std::vector<std::string>& environment = {}) const;
    [[nodiscard]] std::string log(const std::string& name) const;
    /// An application in this swarm.
    [[nodiscard]] Application application(Milliseconds timeout = Milliseconds(5000)) const;

private:
    std::filesystem::path home_;
};

/// Asks again and again, without sleeping long, until it is true; false when the patience is over.
template <class Condition>
bool eventually(Condition condition, Milliseconds patience);

/// Resident memory of a process, bytes.
std::size_t resident_bytes(pid_t pid);
/// Open descriptors of a process.
std::size_t open_descriptors(pid_t pid);
/// Data for tests that lies beside the source tree, when it is there (HIVE_SHARED, or ../shared).
std::optional<std::filesystem::path> shared_data(const std::string& relative);
/// How much slower everything is under a sanitizer: multiply deadlines, skip what measures.
constexpr bool sanitized()
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return true;
#else
    return false;
#endif
}

}  // namespace hive::test

#include "eventually.ipp"
