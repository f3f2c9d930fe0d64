// Finds the processes that take over from drones of a swarm.
#pragma once

#include "swarm.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace hive::test {

/// The processes of this home that are to take over, or have taken over.
inline std::vector<pid_t> successors(const Swarm& swarm)
{
    std::vector<pid_t> found;
    std::error_code ignored;
    const auto home = "HIVE_HOME=" + swarm.home().string() + '\0';
    for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored))
        if (const auto pid = std::atoi(entry.path().filename().c_str());
            pid > 0 && text_of(entry.path() / "cmdline").find("--take-over") != std::string::npos
            && (text_of(entry.path() / "environ") + '\0').find(home) != std::string::npos)
            found.push_back(pid);
    std::ranges::sort(found);
    return found;
}

}  // namespace hive::test
