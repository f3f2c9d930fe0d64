// Writes the command line of each drone of a plan, with the addresses at which the drones reach each other.
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
        as_planned,  ///< drones connect in the home of one machine, and at ports between machines
        one_each     ///< each drone has its own machine: a container
    };
    /// The plan must outlive this object. Throws Errc::invalid_argument if it leaves no port free.
    /// @param hosts  host names of the containers, by drone; a drone that is missing here has its own name
    CommandLines(const SwarmPlan& plan, Machines machines, std::map<std::string, std::string> hosts = {});

    /// The command line of one drone, its program first: "hive-face", or "python3" and the arguments for a Python file.
    /// Throws Errc::invalid_argument if an output is unknown, or another machine cannot reach a sender.
    [[nodiscard]] std::vector<std::string> of(const SwarmDrone& drone) const;

    /// The command line of the server for the metrics of all drones, each on its own machine, at metrics_port.
    [[nodiscard]] std::vector<std::string> metrics() const;

    /// Does any drone need the swarm's key?
    [[nodiscard]] bool with_key() const;

    static constexpr std::uint16_t metrics_port = 9464;
    static constexpr const char* metrics_name = "hive-metrics";
    /// For a machine of its own.
    static constexpr std::uint16_t only_port = 7700;

private:
    void choose_ports(const SwarmPlan& plan);
    [[nodiscard]] std::string machine(const SwarmDrone& drone) const;
    [[nodiscard]] std::string listening(const SwarmDrone& drone) const;
    [[nodiscard]] std::string advertised(const SwarmDrone& drone) const;
    /// The address at which other machines reach it.
    [[nodiscard]] std::string address(const SwarmDrone& drone) const;
    [[nodiscard]] std::string connection(const SwarmConnection& connection, const SwarmDrone& receiver) const;

    Machines machines_;
    const SwarmPlan& plan_;
    std::map<std::string, std::string> hosts_;
    std::map<std::string, const SwarmDrone*> drones_;
    std::map<std::string, std::vector<const SwarmConnection*>> received_;  ///< by receiver
    std::map<std::string, std::uint16_t> ports_;                           ///< of drones on the network
};

/// Quotes an argument for a shell if needed.
std::string shell_word(const std::string& word);
/// The name with lower-case letters, digits and hyphens alone, as Kubernetes and compose require.
std::string label_of(const std::string& name);

}  // namespace hive
