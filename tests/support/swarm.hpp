// Real processes in a home directory of their own: what the end-to-end tests, the contract suite and the benchmarks
// stand on.
#pragma once

#include "eventually.hpp"
#include "process.hpp"

#include <hive/application.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hive::test {

/// What a command came to.
struct Finished {
    int exit_code = -1;  ///< 128 + signal when it was killed
    std::string out, err;
    std::chrono::microseconds took{};
};

/// A fresh home directory (with the user's configuration in it), the built programs, and everything that was started in
/// it; all gone at the end. Its programs see no system bus but one that a test makes, at `bus` in the home: drones of
/// tests are not announced on a real network.
class Swarm {
public:
    Swarm();
    /// Also kills drones that were started in the background by `hivectl start`.
    ~Swarm();
    Swarm(const Swarm&) = delete;
    Swarm& operator=(const Swarm&) = delete;

    [[nodiscard]] const std::filesystem::path& home() const noexcept { return home_; }
    [[nodiscard]] std::filesystem::path program(const std::string& name) const;  ///< "hive-face", "hivectl"
    /// Runs hivectl with a deadline; killed and failed (exit code 137) when it passes.
    Finished hivectl(const std::vector<std::string>& words, Milliseconds patience = Milliseconds(15'000)) const;
    /// As above; throws with everything it said unless it exits with 0. Returns what it printed.
    std::string hivectl_done(const std::vector<std::string>& words, Milliseconds patience = Milliseconds(15'000)) const;
    /// hivectl running beside the test: what it prints goes to `log(name)`.
    [[nodiscard]] Process hivectl_running(const std::vector<std::string>& words, const std::string& name) const;
    /// Any program with this swarm's home in its environment and the built programs first in its path.
    Finished run(const std::vector<std::string>& words, Milliseconds patience = Milliseconds(15'000)) const;
    /// Starts a drone as a child of the test and returns when it answers; throws with its log when it does not.
    /// @param settings     "key=value"
    /// @param more         further words of its command line
    /// @param environment  "NAME=value"
    [[nodiscard]] Process drone(const std::string& kind, const std::string& name,
                                const std::vector<std::string>& settings = {},
                                const std::vector<std::string>& more = {},
                                const std::vector<std::string>& environment = {}) const;
    /// Where the programs of this swarm look for its key; not there until somebody makes it.
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

/// Data for tests that lies beside the source tree, when it is there (HIVE_SHARED, or ../shared).
std::optional<std::filesystem::path> shared_data(const std::string& relative);

}  // namespace hive::test
