// The command line of each drone of a plan, and where the drones reach each other.
#pragma once

#include <hive/swarm_plan.hpp>

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace hive {

class CommandLines {
public:
    enum class Machines {
        as_planned,  ///< drones of one machine meet in its home, and others at a port of it
        one_each     ///< each drone has a machine of its own, called as the drone is: a container
    };
    /// The plan has to outlive it. Throws Errc::invalid_argument when it leaves no port free.
    CommandLines(const SwarmPlan& plan, Machines machines);

    /// The words of one drone, its program first: "hive-face", or "python3" and what runs a file of Python. Throws
    /// Errc::invalid_argument when an output is not known, or a sender cannot be found from another machine.
    [[nodiscard]] std::vector<std::string> of(const SwarmDrone& drone) const;

    /// The words of what serves the metrics of all drones, each on a machine of its own, at metrics_port.
    [[nodiscard]] std::vector<std::string> metrics() const;

    static constexpr std::uint16_t metrics_port = 9464;
    static constexpr const char* metrics_name = "hive-metrics";
    /// Of a machine of its own.
    static constexpr std::uint16_t only_port = 7700;

private:
    void choose_ports(const SwarmPlan& plan);
    [[nodiscard]] std::string machine(const SwarmDrone& drone) const;
    [[nodiscard]] std::string listening(const SwarmDrone& drone) const;
    [[nodiscard]] std::string advertised(const SwarmDrone& drone) const;
    /// Where drones of other machines dial it.
    [[nodiscard]] std::string address(const SwarmDrone& drone) const;
    [[nodiscard]] std::string connection(const SwarmConnection& connection, const SwarmDrone& receiver) const;

    Machines machines_;
    const SwarmPlan& plan_;
    std::map<std::string, const SwarmDrone*> drones_;
    std::map<std::string, std::vector<const SwarmConnection*>> received_;  ///< by receiver
    std::map<std::string, std::uint16_t> ports_;                           ///< of drones on the network
};

/// A word for a shell, in quotation marks where it needs them.
std::string shell_word(const std::string& word);
/// "cam1" of "user@cam1".
std::string machine_name(const std::string& host);

}  // namespace hive
