// Real processes in their own home directory, for the end-to-end tests, the contract suite and the benchmarks.
#pragma once

#include "eventually.hpp"
#include "process.hpp"

#include <hive/application.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hive::test {

/// Result of a command.
struct Finished {
    int exit_code = -1;  ///< 128 + signal when it was killed
    std::string out, err;
    std::chrono::microseconds took{};
};

/// A fresh home directory (with the user's configuration in it), the built programs, and everything that was started in
/// it; all removed at the end. Its programs have no system bus except one that a test creates, at `bus` in the home, so
/// that drones of tests are not announced on a real network.
class Swarm {
public:
    Swarm();
    /// Also kills drones that were started in the background by `hivectl start`.
    ~Swarm();
    Swarm(const Swarm&) = delete;
    Swarm& operator=(const Swarm&) = delete;

    [[nodiscard]] const std::filesystem::path& home() const noexcept { return home_; }
    [[nodiscard]] std::filesystem::path program(const std::string& name) const;  ///< "hive-face", "hivectl"
    /// Runs hivectl with a deadline; then it is killed (exit code 137).
    Finished hivectl(const std::vector<std::string>& words, Milliseconds timeout = Milliseconds(15'000)) const;
    /// As above; throws with all output unless it exits with 0. Returns its stdout.
    std::string hivectl_done(const std::vector<std::string>& words, Milliseconds timeout = Milliseconds(15'000)) const;
    /// Runs hivectl in the background; its output goes to `log(name)`.
    [[nodiscard]] Process hivectl_running(const std::vector<std::string>& words, const std::string& name) const;
    /// Any program with this swarm's home in its environment and the built programs first in its path.
    Finished run(const std::vector<std::string>& words, Milliseconds timeout = Milliseconds(15'000)) const;
    /// Starts a drone as a child of the test and returns when it answers; throws with its log if it does not.
    /// @param settings     "key=value"
    /// @param more         further arguments
    /// @param environment  "NAME=value"
    [[nodiscard]] Process drone(const std::string& kind, const std::string& name,
                                const std::vector<std::string>& settings = {},
                                const std::vector<std::string>& more = {},
                                const std::vector<std::string>& environment = {}) const;
    /// The path of this swarm's key; the file does not exist until it is created.
    [[nodiscard]] std::filesystem::path key_file() const;
    [[nodiscard]] std::string log(const std::string& name) const;
    /// An application in this swarm.
    [[nodiscard]] Application application(Milliseconds timeout = Milliseconds(15'000)) const;

private:
    [[nodiscard]] std::vector<std::string> environment() const;

    std::filesystem::path home_;
    std::filesystem::path programs_;
    mutable int commands_ = 0;
};

/// Test data next to the source tree, if present (HIVE_SHARED, or ../shared).
std::optional<std::filesystem::path> shared_data(const std::string& relative);

}  // namespace hive::test
