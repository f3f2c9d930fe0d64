// Kills a process that does not stop when told to.
#pragma once

#include <chrono>
#include <filesystem>
#include <thread>

namespace hive::service {

class ShutdownWatchdog {
public:
    /// The time limit of a drone that was told to stop.
    static constexpr std::chrono::seconds stop_timeout{2};
    /// The time limit of a drone that is replaced: it finishes its callback, or waits for the decision of a prepared
    /// set, which takes 31 s at most.
    static constexpr std::chrono::seconds hand_over_timeout{35};

    /// Any thread, once. If this object still exists after the grace period, the socket is removed and the process is
    /// killed.
    void begin(const std::filesystem::path& socket, std::chrono::seconds grace = stop_timeout);

private:
    std::jthread thread_;
};

}  // namespace hive::service
