// Finds the processes of the drones of a swarm, and those that take over from them.
#pragma once

#include "swarm.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace hive::test {

/// The processes of this home with these arguments, separated by '\0'.
inline std::vector<pid_t> processes_with(const Swarm& swarm, const std::string& arguments)
{
    std::vector<pid_t> found;
    std::error_code ignored;
    const auto home = "HIVE_HOME=" + swarm.home().string() + '\0';
    for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored))
        if (const auto pid = std::atoi(entry.path().filename().c_str());
            pid > 0 && text_of(entry.path() / "cmdline").find(arguments) != std::string::npos
            && (text_of(entry.path() / "environ") + '\0').find(home) != std::string::npos)
            found.push_back(pid);
    std::ranges::sort(found);
    return found;
}

/// Those that are to take over, or have taken over.
inline std::vector<pid_t> successors(const Swarm& swarm) { return processes_with(swarm, "--take-over"); }
/// Those of a drone, and of its successors.
inline std::vector<pid_t> processes_of(const Swarm& swarm, const std::string& drone)
{
    return processes_with(swarm, std::string("--name") + '\0' + drone + '\0');
}

}  // namespace hive::test
