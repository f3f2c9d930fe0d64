// A whole swarm as one file says it: which drones run where, with which parameters, and how they are connected.
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

/// One connection between two drones of the swarm. A port that the file leaves out is filled in where the interfaces
/// are known; an empty one is inferred when the connection is made.
struct SwarmConnection {
    Endpoint from, to;
    ConnectionOptions options;

    bool operator==(const SwarmConnection& other) const;
};

/// How the processes of one machine are started: {"ssh": "lab-cam1"} has the name `ssh` and the settings "lab-cam1".
struct SwarmEngine {
    std::string name = "local";  ///< local, ssh, systemd or slurm
    Json settings;

    bool operator==(const SwarmEngine&) const = default;
};

/// What a swarm file says, with every count, list of machines and glob written out.
struct SwarmPlan {
    std::string name;
    std::vector<SwarmDrone> drones;                            ///< in the order of the file
    std::vector<SwarmConnection> connections;                  ///< in the order of the file
    std::vector<std::pair<std::string, SwarmEngine>> engines;  ///< by glob over hosts, in the order of the file

    [[nodiscard]] const SwarmDrone* drone(std::string_view name) const;
    /// The first engine whose glob fits; without one, this machine has `local`, and another is reached by ssh under
    /// the name that the file gives it.
    [[nodiscard]] SwarmEngine engine_of(const std::string& host) const;

    bool operator==(const SwarmPlan&) const = default;
};

/// A mistake in a swarm file, where an editor finds it.
struct Mistake {
    std::size_t line = 0, column = 0;  ///< from 1, in characters as editors count them
    std::string at;                    ///< "drones.face.set.scale"; empty: the file as a whole
    std::string text, advice;
    std::string file = {};  ///< an included one; empty: the file itself
};

/// What a swarm file depends on beside its text.
struct SwarmContext {
    std::optional<std::filesystem::path> folder{};   ///< where the file is; without it, it cannot include others
    std::map<std::string, std::string> variables{};  ///< values for its variables, as on a command line
    bool to_be_started = false;  ///< a key that its drones of this machine need, and that is not here, is a mistake
};

struct SwarmReading {
    SwarmPlan plan;                 ///< meaningful without mistakes
    std::vector<Mistake> mistakes;  ///< in the order of the file
    std::vector<Mistake> notes;     ///< what could not be checked here, and why
};

/// Tells the interface of a kind of drone. Throws Errc::not_found when its program is not on this machine, and what
/// else keeps it from telling, as hive::interface_of does. It is asked once for each kind.
using InterfaceOfKind = std::function<Interface(const std::string& kind)>;

/// Reads a swarm file and finds every mistake that can be found without starting anything: of form, names, references
/// and options; with `interface_of`, which is for what a person wrote, also those of ports, their types, encodings,
/// parameters and their ranges, and of engines. A kind that it does not know is a mistake for drones of this machine,
/// and for others, which may have it, a note.
SwarmReading read_swarm(std::string_view text, const InterfaceOfKind& interface_of = {},
                        const SwarmContext& context = {});

/// The same with the interfaces that the programs on this machine tell; they are asked side by side, and those that
/// have not answered within `limit` count as not known.
SwarmReading check_swarm(std::string_view text, std::chrono::milliseconds limit = std::chrono::seconds(10),
                         const SwarmContext& context = {});

/// The file that says this: reading it gives the same plan.
std::string to_text(const SwarmPlan& plan);

/// The JSON Schema of swarm files, for editors.
std::string_view swarm_schema();

}  // namespace hive
