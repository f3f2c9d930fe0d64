// One hivectl on another machine, run over ssh.
#pragma once

#include "engine.hpp"

#include "../running_command.hpp"

#include <atomic>
#include <chrono>
#include <string>
#include <vector>

namespace hive {

class SshSession {
public:
    /// Sessions of one ssh connection: an sshd allows 10 (MaxSessions), and the user may need one.
    static constexpr std::size_t max_of_connection = 8;

    SshSession(std::string name, const std::vector<std::string>& words, std::chrono::milliseconds limit)
        : drone(std::move(name)), command(words, limit)
    {
        ++count_;
    }
    ~SshSession() { --count_; }
    SshSession(const SshSession&) = delete;
    SshSession& operator=(const SshSession&) = delete;

    /// Has this process too many already? Each takes three descriptors.
    [[nodiscard]] static bool is_limit_reached() { return count_ >= max_of_process; }

    const std::string drone;
    RunningCommand command;

private:
    static constexpr int max_of_process = 64;
    inline static std::atomic<int> count_{0};
};

/// Did hivectl there not find the drone, or the key?
inline bool is_not_found(const CommandResult& result) { return errc_of_exit(result.exit_code) == Errc::not_found; }

}  // namespace hive
