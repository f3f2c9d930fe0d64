// The right to change a swarm, which one process has at a time: `up`, `down`, and whoever stays with it and starts
// again what fell.
#pragma once

#include <hive/event/home.hpp>
#include <hive/swarm.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

namespace hive::swarm {

using Claim = std::unique_ptr<const event::NameClaim>;  ///< for as long as it lives

/// Waits while somebody else has it, at least a second, and tells that then: one that was killed may leave a process
/// behind that it was about to start, which has the claim for a moment more. Null when it is cancelled meanwhile.
/// Throws Errc::locked.
Claim claim(Application& application, const std::string& swarm, std::chrono::milliseconds patience,
            const SwarmWatch& watch);
/// Null when somebody else has it, or waits for it.
Claim claim_if_free(const std::filesystem::path& home, const std::string& swarm);
/// Does somebody wait for it?
bool claim_is_wanted(const std::filesystem::path& home, const std::string& swarm);

}  // namespace hive::swarm
