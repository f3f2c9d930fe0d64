// Verbs for drones on other machines, over ssh.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <string_view>

namespace hivectl {

class Session;

/// Stops a drone that was started over ssh and does not answer here, or discards its state there if it crashed. Returns
/// the exit code of hivectl there.
int stop_remotely(Session& session, const hive::Place& place);
/// Prints lines of another machine's stderr, each after the machine's name and without the prefix of hivectl.
void relay_errors(std::string_view verb, const std::string& host, const std::string& text);

}  // namespace hivectl
