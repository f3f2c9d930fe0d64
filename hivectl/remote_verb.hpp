// Verbs for drones on other machines, through ssh.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <string_view>

namespace hivectl {

class Session;

/// Ends a drone that was started through ssh and does not answer here, or has it forgotten if it crashed. Returns the
/// exit code of hivectl there.
int stop_remotely(Session& session, const hive::Place& place);
/// Lines of another machine's stderr, each with the machine's name before it, without what hivectl puts there.
void repeat_complaints(std::string_view verb, const std::string& host, const std::string& text);

}  // namespace hivectl
