// The words of a swarm file, and what its values may be. The schema, ../swarm.schema.json, says the same for editors.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace hive::swarm_file {

using namespace std::string_view_literals;

inline constexpr std::array file_keys{"$schema"sv,  "swarm"sv,  "include"sv,     "variables"sv,
                                      "defaults"sv, "drones"sv, "connections"sv, "engines"sv};
/// With those of the fields of an order.
std::span<const std::string_view> drone_keys();
inline constexpr std::array connection_keys{"from"sv,        "to"sv,    "stream"sv, "notify"sv, "window"sv,
                                            "first_frame"sv, "share"sv, "group"sv,  "lease"sv,  "encoding"sv};
inline constexpr std::array engine_keys{"local"sv, "ssh"sv, "systemd"sv, "slurm"sv};
inline constexpr std::array slurm_keys{"partition"sv, "options"sv};

inline constexpr int most_of_a_kind = 1000;
inline constexpr int widest_window = 64;
inline constexpr double shortest_lease_s = 0.05, longest_lease_s = 86'400;

/// The name that who changes a swarm has meanwhile; as long as any name at most.
inline std::string lock_of(const std::string& swarm) { return swarm + ".swarm"; }

/// May a machine be called so in a file? HOST or USER@HOST, never an option of ssh, nor a glob.
bool is_machine(std::string_view text) noexcept;

}  // namespace hive::swarm_file
