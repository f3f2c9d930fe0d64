// What the page can ask of drones or have them do.
#pragma once

#include "errands.hpp"

#include <string>

namespace hivectl::dash {

/// Reads what the page sends: {"do": "set", "drone": "face", "values": {"scale": 1.05}}; "halt", "resume", "stop" and
/// "replace" of a drone; "connect" with "from", "to" and those of "window", "transfer" and "encoding" that are to
/// change. Throws Errc::malformed and Errc::invalid_argument.
Errands::Work order_in(std::string_view body);

/// {"interface", "values", "log": text, "log_problem": text}: what a drone offers and has now, and the end of its log.
Errands::Work ask_of(std::string drone);
/// What stands in the way between two drones, as of explain.
Errands::Work explain_of(std::string sender, std::string receiver);

}  // namespace hivectl::dash
