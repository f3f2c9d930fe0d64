// Reads a swarm file from a file or stdin, and prints its errors in the style of compilers.
#pragma once

#include <hive/swarm_plan.hpp>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hivectl {

class CommandLine;
class Option;

/// A swarm file as a command line names it.
struct SwarmInput {
    std::string file;                   ///< "-": stdin
    std::vector<std::string> settings;  ///< --set: values of its variables
};
/// Declares --set.
Option declare_variables(CommandLine& line, SwarmInput& input);

/// @param to_be_started  also checks the keys and addresses that its drones need here
hive::SwarmReading swarm_reading(const SwarmInput& input, std::chrono::milliseconds limit, bool to_be_started = false);
/// "doorway.json:3:14: text; advice", the form to which editors can jump.
std::string mistake_text(const std::string& file, const hive::Mistake& mistake);
/// "7 drones on 3 machines, 6 connections"
std::string size_text(const hive::SwarmPlan& plan);

/// The plan of the file; nothing if it has errors, which are printed on stderr.
std::optional<hive::SwarmPlan> read_plan(std::string_view verb, const SwarmInput& input, bool to_be_started = false);

}  // namespace hivectl
