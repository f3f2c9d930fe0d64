// The right to change a swarm, for one process at a time: `up`, `down`, or the one that restarts crashed drones.
#pragma once

#include <hive/event/home.hpp>
#include <hive/swarm.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

namespace hive::swarm {

using Claim = std::unique_ptr<const event::NameClaim>;  ///< held as long as it lives

/// Waits while another process has it, at least a second, and then reports that: a killed process may leave a child,
/// forked but not yet running its program, which keeps the claim a little longer. Null if cancelled meanwhile. Throws
/// Errc::locked.
Claim claim(Application& application, const std::string& swarm, std::chrono::milliseconds timeout,
            const SwarmWatch& watch);
/// Null if another process has it or waits for it.
Claim claim_if_free(const std::filesystem::path& home, const std::string& swarm);
/// Does another process wait for it?
bool claim_is_wanted(const std::filesystem::path& home, const std::string& swarm);

}  // namespace hive::swarm
