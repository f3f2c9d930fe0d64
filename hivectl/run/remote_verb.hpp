// Verbs for drones on other machines, over ssh.
#pragma once

#include <hive/application.hpp>
#include <hive/process.hpp>

#include <string>
#include <vector>

namespace hivectl {

class Session;

/// Runs hivectl on the machine of a drone that was started over ssh. Its stderr is printed here, each line after the
/// machine's name and without the prefix of hivectl.
/// @param awaited  for the status line: "the log of face"
hive::CommandResult run_there(Session& session, const hive::Place& place, const std::vector<std::string>& words,
                              const std::string& awaited);

}  // namespace hivectl
