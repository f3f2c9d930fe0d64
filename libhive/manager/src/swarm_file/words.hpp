// The keywords of a swarm file, and its valid values. The schema for editors, ../swarm.schema.json, has the same rules.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace hive::swarm_file {

using namespace std::string_view_literals;

inline constexpr std::array file_keys{"$schema"sv,  "swarm"sv,  "include"sv,     "variables"sv,
                                      "defaults"sv, "drones"sv, "connections"sv, "engines"sv};
/// Includes those of the fields of an order.
std::span<const std::string_view> drone_keys();
/// Includes those of the options of a connection.
std::span<const std::string_view> connection_keys();
inline constexpr std::array engine_keys{"local"sv, "ssh"sv, "systemd"sv, "slurm"sv};
inline constexpr std::array slurm_keys{"partition"sv, "options"sv, "job"sv};

inline constexpr int most_of_a_kind = 1000;

/// The name of a swarm's lock; at most as long as any name.
inline std::string lock_of(const std::string& swarm) { return swarm + ".swarm"; }

/// Is it a valid machine in a file? HOST or USER@HOST, never an option of ssh or a glob.
bool is_machine(std::string_view text);

}  // namespace hive::swarm_file
