// Executes the commands and queries of the page.
#pragma once

#include "errands.hpp"

#include <string>

namespace hivectl::dash {

/// Parses a command of the page: {"do": "set", "drone": "face", "values": {"scale": 1.05}}; "halt", "resume", "stop"
/// and "replace" of a drone; "connect" with "from", "to" and those of "window", "transfer" and "encoding" that are to
/// change. Throws Errc::malformed and Errc::invalid_argument.
Errands::Work order_in(std::string_view body);

/// {"interface", "values", "failures", "log": text, "log_problem": text}: the interface and current values of a drone,
/// its failures kept on this machine, with the headers of their inputs as text, and the end of its log. Of a drone that
/// does not run, there are only the last three.
Errands::Work ask_of(std::string drone);
/// {"type", "bytes"}: the image in the inputs of a kept failure, as for a live image.
Errands::Work image_of(std::string drone, std::int64_t number);
/// Where the time of events goes on their way to a drone, and what would help, as from advise. Measures for 2 s.
/// @param goal  "fps" or "latency"
Errands::Work advise_of(std::string drone, const std::string& goal);
/// What blocks events between two drones, as from explain.
Errands::Work explain_of(std::string sender, std::string receiver);

}  // namespace hivectl::dash
