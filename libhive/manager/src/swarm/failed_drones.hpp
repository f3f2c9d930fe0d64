// Drones that crash repeatedly: kept in the home until they run again or are stopped.
#pragma once

#include <hive/application.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace hive::swarm {

class FailedDrones {
public:
    explicit FailedDrones(std::filesystem::path home) : home_(std::move(home)) {}

    /// Adds the last lines of the drone's log, if that is on this machine. Throws Errc::io.
    void add(FailedDrone failed) const;
    /// False: not found.
    bool forget(const std::string& drone) const;
    /// Sorted by name. Unreadable files are skipped.
    [[nodiscard]] std::vector<FailedDrone> all() const;

private:
    [[nodiscard]] std::filesystem::path file(const std::string& drone) const { return home_ / (drone + ".failed"); }

    std::filesystem::path home_;
};

}  // namespace hive::swarm
