// The programs that a process of the world can start by a command line.
#pragma once

#include "world.hpp"

#include <hive/interface.hpp>

namespace hive::simulation {

/// Set by the ground of a round.
struct Programs {
    /// The program first, then its arguments.
    std::function<Process&(const std::vector<std::string>& words)> start{};
    std::function<Interface(const std::string& kind)> describe{};
};
Programs& programs();

}  // namespace hive::simulation
