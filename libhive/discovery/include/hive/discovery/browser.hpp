// Finds the drones that announce themselves on the local network.
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

/// For one thread. Nothing is done before it is first asked, and nothing at all without a key or a system bus.
class Browser {
public:
    /// @param key   the swarm's key file; empty: there is none
    /// @param note  a file that says when this machine was last listened to, so that the next one need not wait
    Browser(std::filesystem::path key, std::filesystem::path note);
    ~Browser();
    Browser(const Browser&) = delete;
    Browser& operator=(const Browser&) = delete;

    /// The drones of our own key. The first time it waits for what the daemon knows, which it tells in milliseconds
    /// unless the machine is busy: until it has said nothing new for `longest_silence`, for `longest_wait` at most. It
    /// also waits for what the network tells in 300 ms; from then on it knows what is announced and taken back.
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
