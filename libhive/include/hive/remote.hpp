// Runs hivectl on another machine over ssh, with the user's ssh configuration.
#pragma once

#include <hive/error.hpp>
#include <hive/process.hpp>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace hive {

/// One machine. Its connection is kept open for a minute, for the commands that follow.
class Remote {
public:
    /// Exit codes if hivectl did not run: ssh failed, or the shell there found no hivectl.
    static constexpr int ssh_failed = 255, no_hivectl = 127;

    /// @param ssh   the ssh host: a host or an alias of ~/.ssh/config, with or without USER@
    /// @param home  where the socket of the connection is
    Remote(std::string ssh, const std::filesystem::path& home);

    /// "cam1" of "user@cam1": the machine's name in the HOST column.
    [[nodiscard]] std::string host() const;
    /// The HostName of its ssh configuration.
    [[nodiscard]] std::string address(std::chrono::milliseconds limit) const;
    /// Runs hivectl there. Throws Errc::unreachable if ssh fails, Errc::not_found if there is no hivectl,
    /// Errc::timeout; the output of hivectl itself is in the result.
    [[nodiscard]] CommandResult hivectl(const std::vector<std::string>& words, std::chrono::milliseconds limit) const;
    /// The same with our stdout and stderr, for verbs that run until Ctrl-C. Returns the exit code.
    [[nodiscard]] int hivectl_attached(const std::vector<std::string>& words) const;

    // --- the same in steps, for callers that do not wait ---
    /// The command that runs hivectl there.
    [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& words) const;
    /// Throws as hivectl() does.
    void require_there(const CommandResult& result) const;
    /// Why the hivectl there failed, as it printed it with --json, or else its last line; after the machine's name.
    [[nodiscard]] Error error_of(const CommandResult& result) const;
    /// Where a drone there is reachable from here: the first of its places on the network; if that listens at all
    /// addresses, at `address`, the machine's own. Throws Errc::failed if there is none.
    [[nodiscard]] std::string met_at(const std::vector<std::string>& places, const std::string& address) const;

private:
    std::string ssh_;
    std::filesystem::path home_;
};

/// The shell command that copies a key file to its default path on a machine.
std::string copy_of_key(const std::filesystem::path& file, const std::string& ssh);

/// Quotes an argument for a shell.
std::string quoted_for_shell(const std::string& word);

}  // namespace hive
