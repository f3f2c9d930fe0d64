// stdout for data and stderr for people; nothing that came from elsewhere can steer the terminal.
#pragma once

#include <hive/json.hpp>
#include <hive/printable.hpp>

#include <string>
#include <string_view>

namespace hivectl {

/// Writes to stdout at once. A reader that has gone ends the process quietly, as SIGPIPE does; another failure is
/// Errc::io.
void write_out(std::string_view text);
/// Writes to stderr at once.
void write_error(std::string_view text);
/// One line on stderr: "hivectl VERB: text".
void complain(std::string_view verb, std::string_view text);
/// Is stdout a terminal?
bool on_terminal();

using hive::printable;
/// One JSON text without line ends, in which every control character is an escape.
std::string json_text(const hive::Json& value);
/// A value as the shell wants it: texts bare, everything else as JSON. On a terminal it is made printable.
std::string bare(const hive::Json& value);

}  // namespace hivectl
