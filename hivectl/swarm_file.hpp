// A swarm file as verbs see it: read from a file or stdin, its mistakes printed as compilers do.
#pragma once

#include <hive/swarm_plan.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace hivectl {

/// The text of a swarm file; "-": stdin.
std::string swarm_text(const std::string& file);
/// "doorway.json:3:14: text; advice", as editors jump to it.
std::string mistake_text(const std::string& file, const hive::Mistake& mistake);
/// "7 drones on 3 machines, 6 connections"
std::string size_text(const hive::SwarmPlan& plan);

/// What the file says; nothing when it has mistakes: they are on stderr then.
std::optional<hive::SwarmPlan> read_plan(std::string_view verb, const std::string& file);

}  // namespace hivectl
