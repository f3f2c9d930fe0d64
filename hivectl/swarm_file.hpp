// A swarm file as verbs see it: read from a file or stdin, its mistakes printed as compilers do.
#pragma once

#include <hive/swarm_plan.hpp>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hivectl {

class CommandLine;

/// A swarm file as it is meant on a command line.
struct SwarmInput {
    std::string file;                   ///< "-": stdin
    std::vector<std::string> settings;  ///< --set: values of its variables
};
/// Declares --set.
void declare_variables(CommandLine& line, SwarmInput& input);

/// @param to_be_started  also looks for the keys that its drones need here
hive::SwarmReading swarm_reading(const SwarmInput& input, std::chrono::milliseconds limit, bool to_be_started = false);
/// "doorway.json:3:14: text; advice", as editors jump to it.
std::string mistake_text(const std::string& file, const hive::Mistake& mistake);
/// "7 drones on 3 machines, 6 connections"
std::string size_text(const hive::SwarmPlan& plan);

/// What the file says; nothing when it has mistakes: they are on stderr then.
std::optional<hive::SwarmPlan> read_plan(std::string_view verb, const SwarmInput& input, bool to_be_started = false);

}  // namespace hivectl
