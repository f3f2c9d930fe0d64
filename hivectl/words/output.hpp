// stdout for data and stderr for people; remote text cannot control the terminal.
#pragma once

#include <hive/json.hpp>
#include <hive/printable.hpp>

#include <string>
#include <string_view>

namespace hivectl {

/// Writes to stdout without buffering. If the reader has closed it, the process exits quietly, as by SIGPIPE; another
/// failure is Errc::io.
void write_out(std::string_view text);
/// Writes to stderr without buffering.
void write_error(std::string_view text);
/// One line on stderr: "hivectl VERB: text".
void complain(std::string_view verb, std::string_view text);
/// The same for each line of a text, which may include the last lines of a log.
void complain_in_lines(std::string_view verb, const std::string& text);
/// Is stdout a terminal?
bool on_terminal();

using hive::printable;
/// One JSON text without line ends, in which every control character is an escape.
std::string json_text(const hive::Json& value);
/// A value for the shell: texts bare, everything else as JSON; made printable on a terminal.
std::string bare(const hive::Json& value);

}  // namespace hivectl
