// Lays out help: usage, description, arguments, options, examples.
#include "run/help.hpp"

#include "run/command_line.hpp"
#include "words/terminal.hpp"

#include <algorithm>
#include <sstream>

namespace hivectl {
namespace {

constexpr std::size_t line_width = 80;

/// Wraps each paragraph by itself.
std::string paragraphs(std::string_view text)
{
    const auto end = text.find("\n\n");
    return wrapped(text.substr(0, end), 0, 0, line_width)
           + (end == std::string_view::npos ? "" : "\n\n" + paragraphs(text.substr(end + 2)));
}

/// "  left            right, wrapped"
std::string entry(std::string_view left, std::string_view right, std::size_t indent)
{
    std::string line = "  " + std::string(left);
    line += line.size() + 2 <= indent ? std::string(indent - line.size(), ' ') : "\n" + std::string(indent, ' ');
    return line + wrapped(right, indent, indent, line_width) + "\n";
}

/// "-n, --count N"
std::string option_left(const CommandLine::Entry& option)
{
    std::string text;
    for (const auto& name : option.short_names)
        text += (text.empty() ? "-" : ", -") + name;
    for (const auto& name : option.long_names)
        text += (text.empty() ? "--" : ", --") + name;
    return option.type.empty() ? text : text + " " + option.type;
}

std::string examples(std::string_view text)
{
    std::istringstream lines{std::string(text)};
    std::vector<std::pair<std::string, std::string>> rows;
    std::size_t indent = 0;
    for (std::string line; std::getline(lines, line);) {
        const auto gap = line.find("  ");
        const auto begin = line.find_first_not_of(' ', gap);
        rows.emplace_back(line.substr(0, gap), begin == std::string::npos ? "" : line.substr(begin));
        indent = std::max(indent, rows.back().first.size());
    }
    std::string result;
    for (const auto& [command, meaning] : rows)
        result +=
            "  " + command + (meaning.empty() ? "" : std::string(indent - command.size() + 2, ' ') + meaning) + "\n";
    return result;
}

}  // namespace

std::string overview(const std::vector<Verb>& all)
{
    std::string text = "hivectl VERB ...: run drones, connect them into a swarm, set parameters, collect results.\n";
    std::string_view group;
    for (const auto& verb : all) {
        if (verb.group.empty())
            continue;
        if (verb.group != group)
            text += "\n" + std::string(verb.group) + ":\n";
        group = verb.group;
        text += entry(
            verb.name,
            std::string(verb.summary) + (verb.alias.empty() ? "" : " (also: " + std::string(verb.alias) + ")"), 14);
    }
    return text
           + "\nfirst steps:\n"
             "  hivectl start camera           run a drone\n"
             "  hivectl start face\n"
             "  hivectl connect camera face    camera sends its images to face\n"
             "  hivectl results face -n 5      the next five results\n"
             "  hivectl set face scale=1.05    change a parameter while it runs\n"
             "  hivectl stop --all\n"
             "\nEvery verb has --help, --json and --timeout SECONDS. NAME may be a glob: 'face-*'.\n"
             "A time may have a unit: 500ms, 2s, 5min; so may a size: 200MB, 2GB.\n"
             "The runtime directory is $HIVE_HOME, or else $XDG_RUNTIME_DIR/hive, or else\n"
             "/tmp/hive-UID; each drone writes NAME.log there.\n"
             "exit codes: 0 done, 1 failure, 2 usage, 3 no such drone, port or parameter,\n"
             "4 unreachable, 5 refused, 6 types do not fit, 7 halted, 8 partly done,\n"
             "9 a fault was found (audit, explain), 124 timed out, 130 interrupted (143 by SIGTERM)\n";
}

std::string help_of(const Verb& verb, const CommandLine& line)
{
    std::string text = "hivectl " + std::string(verb.name) + (verb.usage.empty() ? "" : " " + std::string(verb.usage))
                       + "\n\n" + wrapped(verb.summary, 0, 0, line_width) + ".\n";
    if (!verb.details.empty())
        text += "\n" + paragraphs(verb.details) + "\n";
    std::string arguments, options;
    for (const auto& option : line.entries()) {
        if (option.positional)
            arguments += entry(option.name, option.meaning, 22);
        else
            options += entry(option_left(option), option.meaning, 22);
    }
    if (!arguments.empty())
        text += "\narguments:\n" + arguments;
    text += "\noptions:\n" + options;
    if (!verb.examples.empty())
        text += "\nexamples:\n" + examples(verb.examples);
    return text;
}

}  // namespace hivectl
