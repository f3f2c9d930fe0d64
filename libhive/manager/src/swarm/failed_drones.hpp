// Drones that crash again and again: remembered in the home until they run once more or are stopped.
#pragma once

#include <hive/application.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace hive::swarm {

class FailedDrones {
public:
    explicit FailedDrones(std::filesystem::path home) : home_(std::move(home)) {}

    /// With the last lines of the drone's log, where it is on this machine. Throws Errc::io.
    void add(FailedDrone failed) const;
    /// False: it was not there.
    bool forget(const std::string& drone) const;
    /// Sorted by name. What cannot be read is left out.
    [[nodiscard]] std::vector<FailedDrone> all() const;

private:
    [[nodiscard]] std::filesystem::path file(const std::string& drone) const { return home_ / (drone + ".failed"); }

    std::filesystem::path home_;
};

}  // namespace hive::swarm
