// The plan of a swarm, as in a swarm file: which drones run where, with which parameters, and how they are connected.
#pragma once

#include <hive/application.hpp>
#include <hive/drone_order.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hive {

using SwarmDrone = DroneOrder;

/// How the processes of one machine are started: {"ssh": "lab-cam1"} has the name `ssh` and the settings "lab-cam1".
struct SwarmEngine {
    std::string name = "local";  ///< local, ssh, systemd or slurm
    Json settings;

    bool operator==(const SwarmEngine&) const = default;
};

/// The content of a swarm file, with every count, list of machines and glob expanded.
struct SwarmPlan {
    std::string name;
    std::vector<SwarmDrone> drones;                            ///< in the order of the file
    std::vector<SwarmConnection> connections;                  ///< in the order of the file
    std::vector<std::pair<std::string, SwarmEngine>> engines;  ///< by glob over hosts, in the order of the file

    [[nodiscard]] const SwarmDrone* drone(std::string_view name) const;
    /// The first engine whose glob matches; without one, `local` for this machine, and for another one ssh with its
    /// name in the file.
    [[nodiscard]] SwarmEngine engine_of(const std::string& host) const;

    bool operator==(const SwarmPlan&) const = default;
};

/// An error in a swarm file, with its position for editors.
struct Mistake {
    std::size_t line = 0, column = 0;  ///< from 1, in characters as editors count them
    std::string at;                    ///< "drones.face.set.scale"; empty: the file as a whole
    std::string text, advice;
    std::string file = {};  ///< an included one; empty: the file itself
};

/// What a swarm file depends on besides its text.
struct SwarmContext {
    std::optional<std::filesystem::path> folder{};   ///< of the file; without it, the file cannot include others
    std::map<std::string, std::string> variables{};  ///< values for the file's variables
    /// Missing keys of this machine are errors, and so are addresses to listen at that it does not have.
    bool to_be_started = false;
};

struct SwarmReading {
    SwarmPlan plan;                 ///< meaningful without mistakes
    std::vector<Mistake> mistakes;  ///< in the order of the file
    std::vector<Mistake> notes;     ///< what could not be checked here, and why
};

/// Returns the interface of a kind of drone. Throws as hive::interface_of, Errc::not_found if its program is not on
/// this machine. Called once per kind.
using InterfaceOfKind = std::function<Interface(const std::string& kind)>;

/// Reads a swarm file and finds every error that can be found without starting anything: in syntax, names, references
/// and options; with `interface_of`, for files that a person wrote, also in ports, types, encodings, parameters, their
/// ranges, and engines. A kind that it does not know is an error for drones of this machine, and a note for others,
/// which may have it.
SwarmReading read_swarm(std::string_view text, const InterfaceOfKind& interface_of = {},
                        const SwarmContext& context = {});

/// The same with the interfaces of the programs on this machine, queried in parallel; those that have not answered
/// within `limit` count as unknown.
SwarmReading check_swarm(std::string_view text, std::chrono::milliseconds limit = std::chrono::seconds(10),
                         const SwarmContext& context = {});

/// The text of a swarm file that is read as this plan.
std::string to_text(const SwarmPlan& plan);

/// The JSON Schema of swarm files, for editors.
std::string_view swarm_schema();

}  // namespace hive
