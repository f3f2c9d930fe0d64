// What a verb of hivectl is: its words for --help, its arguments, and what it does.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

namespace hivectl {

class CommandLine;
class Session;

/// What stands at a place of the command line, for completion. The last one of a verb repeats.
enum class Operand { kind, drone, failed_drone, sender, receiver, setting, setting_of_kind, parameter, file, other };

/// Does what was asked once the command line has been read; returns the exit code.
using Run = std::function<int()>;

struct Verb {
    std::string_view name = {};
    std::string_view alias = {};     ///< a second name, or empty
    std::string_view group = {};     ///< the heading it stands under in `hivectl --help`; empty: not shown there
    std::string_view usage = {};     ///< what follows the name: "NAME... [options]"
    std::string_view summary = {};   ///< one line
    std::string_view details = {};   ///< some sentences, for the verb's own help
    std::string_view examples = {};  ///< one a line: command, two spaces or more, what it does
    std::string_view timeout = "give up after this long (default 5)";  ///< what --timeout means here
    bool table = false;  ///< prints a table, which --wide leaves as wide as needed
    std::vector<Operand> operands = {};
    /// Declares options and arguments; what it returns is called after a successful parse.
    Run (*declare)(CommandLine& line, Session& session) = nullptr;
};

}  // namespace hivectl
