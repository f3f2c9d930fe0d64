// A verb of hivectl: its help texts, arguments and action, and the headers that every verb needs.
#pragma once

#include "run/command_line.hpp"
#include "run/session.hpp"
#include "words/exit_code.hpp"
#include "words/output.hpp"
#include "words/table.hpp"

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

namespace hivectl {

/// The kind of a positional argument, for completion. The last one of a verb repeats.
enum class Operand { kind, drone, failed_drone, sender, receiver, setting, setting_of_kind, parameter, file, other };

/// Runs the verb after the command line is parsed; returns the exit code.
using Run = std::function<int()>;

struct Verb {
    std::string_view name = {};
    std::string_view alias = {};     ///< a second name, or empty
    std::string_view group = {};     ///< its heading in `hivectl --help`; empty: hidden
    std::string_view usage = {};     ///< what follows the name: "NAME... [options]"
    std::string_view summary = {};   ///< one line
    std::string_view details = {};   ///< some sentences, for the verb's own help
    std::string_view examples = {};  ///< one per line: command, two or more spaces, description
    std::string_view timeout = "give up after this long (default 5)";  ///< the help of --timeout
    bool table = false;                                                ///< prints a table, so it has --wide
    std::vector<Operand> operands = {};
    /// Declares options and arguments; returns the action for after a successful parse.
    std::function<Run(CommandLine& line, Session& session)> declare = {};
};

/// For a verb with options: `declare` adds them to the command line, and `run` gets their values.
template <typename Options>
auto with(void (*declare)(CommandLine&, Options&), int (*run)(const Options&, Session&))
{
    return [=](CommandLine& line, Session& session) {
        const auto options = std::make_shared<Options>();
        declare(line, *options);
        return [=, &session] { return run(*options, session); };
    };
}

}  // namespace hivectl
