// A round from its seed to its end, in a world of its own.
#pragma once

#include <round.hpp>

#include <chrono>
#include <cstdint>

namespace hive::simulation {

struct Played : mixtures::Played {
    std::uint64_t digest = 0;    ///< of all that happened
    std::uint64_t handlers = 0;  ///< of all network sides
    std::chrono::nanoseconds time{};
};

/// Drones that begin now meet in an empty directory, which is removed at the end of the process.
void enter_empty_home();

/// In an empty home. For one thread of the process.
Played play(const mixtures::Plan& plan, bool trace = false);

}  // namespace hive::simulation
