// Ends a process that was told to end and does not.
#pragma once

#include <chrono>
#include <filesystem>
#include <thread>

namespace hive::service {

class LastGrace {
public:
    /// A drone told to stop ends within this, whatever its code does.
    static constexpr std::chrono::seconds length{2};
    /// One that hands over finishes the callback that it is in.
    static constexpr std::chrono::seconds length_to_hand_over{30};

    /// Any thread, once. If this object still lives after the grace, the socket is removed and the process ends.
    void begin(const std::filesystem::path& socket, std::chrono::seconds grace = length);

private:
    std::jthread thread_;
};

}  // namespace hive::service
