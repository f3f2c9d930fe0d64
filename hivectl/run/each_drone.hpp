// Verbs that act on each of some drones: halt, resume.
#pragma once

#include "verb.hpp"

#include <hive/application.hpp>

namespace hivectl {

/// Declares the argument NAME... and, for each drone it names, does `action` and prints the name.
/// @param done  the outcome, as a key of --json: "halted"
Run for_each_drone(CommandLine& line, Session& session, std::string_view verb, std::string_view done,
                   void (hive::Application::*action)(const std::string&));

}  // namespace hivectl
