// Kills a process that does not stop when told to.
#pragma once

#include <chrono>
#include <filesystem>
#include <thread>

namespace hive::service {

class ShutdownWatchdog {
public:
    /// The time limit of a drone that was told to stop.
    static constexpr std::chrono::seconds length{2};
    /// The time limit of a drone that is replaced, which finishes its running callback, or a prepared set.
    static constexpr std::chrono::seconds length_to_hand_over{30};

    /// Any thread, once. If this object still exists after the grace period, the socket is removed and the process is
    /// killed.
    void begin(const std::filesystem::path& socket, std::chrono::seconds grace = length);

private:
    std::jthread thread_;
};

}  // namespace hive::service
