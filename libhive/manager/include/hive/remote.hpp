// hivectl on another machine, through ssh as its user has set it up.
#pragma once

#include <hive/process.hpp>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace hive {

/// One machine. Its connection is kept open for a minute, for the commands that follow.
class Remote {
public:
    /// @param ssh   how ssh calls the machine: a host or a name of ~/.ssh/config, with or without USER@
    /// @param home  where the connection is kept
    Remote(std::string ssh, const std::filesystem::path& home);

    /// "cam1" of "user@cam1": what the machine is called in the HOST column.
    [[nodiscard]] std::string host() const;
    /// Where ssh finds it: the HostName of its configuration.
    [[nodiscard]] std::string address(std::chrono::milliseconds limit) const;
    /// Runs hivectl there. Throws Errc::unreachable when ssh does not get there, Errc::not_found when there is no
    /// hivectl, Errc::timeout; what hivectl itself says there is in the result.
    [[nodiscard]] CommandResult hivectl(const std::vector<std::string>& words, std::chrono::milliseconds limit) const;
    /// The same with our stdout and stderr, for what goes on until Ctrl-C. Returns the exit code.
    [[nodiscard]] int hivectl_attached(const std::vector<std::string>& words) const;

    // --- the same in pieces, for who does not wait ---
    /// What runs hivectl there.
    [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& words) const;
    /// Throws as hivectl() does.
    void require_there(const CommandResult& result) const;
    /// Where a drone there is met from here: the first of its places that is on the network; of one that listens
    /// everywhere, at `address`, which is that of the machine. Throws Errc::failed when there is none.
    [[nodiscard]] std::string met_at(const std::vector<std::string>& places, const std::string& address) const;

private:
    std::string ssh_;
    std::filesystem::path home_;
};

/// The line for a shell that copies a key file to a machine, to where programs look for it.
std::string copy_of_key(const std::filesystem::path& file, const std::string& ssh);

/// A word as a shell reads it back.
std::string quoted_for_shell(const std::string& word);

}  // namespace hive
