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
/// With those of the options of a connection.
std::span<const std::string_view> connection_keys();
inline constexpr std::array engine_keys{"local"sv, "ssh"sv, "systemd"sv, "slurm"sv};
inline constexpr std::array slurm_keys{"partition"sv, "options"sv};

inline constexpr int most_of_a_kind = 1000;

/// The name that who changes a swarm has meanwhile; as long as any name at most.
inline std::string lock_of(const std::string& swarm) { return swarm + ".swarm"; }

/// May a machine be called so in a file? HOST or USER@HOST, never an option of ssh, nor a glob.
bool is_machine(std::string_view text) noexcept;

}  // namespace hive::swarm_file
