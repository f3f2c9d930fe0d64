// Finds the drones that are announced on the local network.
#pragma once

#include <hive/discovery/announcement.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <vector>

namespace hive::transport {
class KeyRing;
}

namespace hive::discovery {

class DaemonThread;

/// For one thread. Does nothing before the first call of found(), and nothing at all without a key or a system bus.
class Browser {
public:
    /// @param key   the swarm's key file; empty: there is none
    /// @param note  a file that says when this machine last browsed, so that the next browser need not wait
    Browser(std::filesystem::path key, std::filesystem::path note);
    ~Browser();
    Browser(const Browser&) = delete;
    Browser& operator=(const Browser&) = delete;

    /// The drones of our own key. The first call waits for the daemon's cache, which comes within milliseconds unless
    /// the machine is busy: until nothing new has come for `longest_silence`, for at most `longest_wait`. It also waits
    /// 300 ms for answers from the network; later calls return at once, since announcements and withdrawals arrive by
    /// themselves.
    [[nodiscard]] std::vector<Neighbour> found();

    static constexpr std::chrono::milliseconds longest_silence{1000};
    static constexpr std::chrono::milliseconds longest_wait{5000};

private:
    class Work;
    void begin();

    std::filesystem::path note_;
    std::unique_ptr<transport::KeyRing> keys_;
    std::shared_ptr<Work> work_;
    std::unique_ptr<DaemonThread> thread_;
};

}  // namespace hive::discovery
