// hivectl complete: prints the completions of an unfinished command line for the completion scripts.
#include "../verbs.hpp"
#include "words/targets.hpp"

#include <hive/program.hpp>

#include <algorithm>

namespace hivectl::complete_verb {
namespace {

using namespace std::chrono_literals;
using Words = std::vector<std::string>;

/// The ports of the drone that `current` names before its dot, or all drones.
Words ends(hive::Application& application, const std::string& current, bool outputs)
{
    const Words drones = application.drones();
    for (const auto& drone : drones)
        if (current.starts_with(drone + ".")) {
            const auto interface = application.describe(drone);
            Words ports;
            for (const auto& port : outputs ? interface.outputs : interface.inputs)
                ports.push_back(drone + "." + port.name);
            return ports;
        }
    return drones;
}

/// The values after "key="; none for numbers.
Words values(const hive::ParameterInfo& parameter)
{
    return parameter.type == hive::ParameterType::flag ? Words{"true", "false"} : parameter.choices;
}

std::vector<hive::Interface> interfaces_of(hive::Application& application, const std::string& drones)
{
    std::vector<hive::Interface> found;
    for (const auto& drone : application.find(drones))
        found.push_back(application.describe(drone));
    return found;
}

/// "key" or "key=" while the key is typed, then "key=value".
Words parameters(const std::vector<hive::Interface>& interfaces, const std::string& current, bool settings)
{
    Words words;
    for (const auto& interface : interfaces)
        for (const auto& parameter : interface.parameters) {
            const auto key = parameter.name + (settings ? "=" : "");
            if (!settings || !current.starts_with(key))
                add_new(words, {key});
            else
                for (const auto& value : values(parameter))
                    add_new(words, {key + value});
        }
    return words;
}

Words operands(Operand operand, const std::string& first, const std::string& kind, const std::string& current,
               Session& session)
{
    switch (operand) {
    case Operand::kind: return hive::kinds();
    case Operand::drone: return session.application(300ms).drones();
    case Operand::failed_drone: return session.application(300ms).failing();
    case Operand::sender: return ends(session.application(300ms), current, true);
    case Operand::receiver: return ends(session.application(300ms), current, false);
    case Operand::parameter: return parameters(interfaces_of(session.application(300ms), first), current, false);
    case Operand::setting:
        if (kind.empty())
            return parameters(interfaces_of(session.application(300ms), first), current, true);
        return parameters({hive::interface_of(kind, 3s)}, current, true);
    case Operand::setting_of_kind: return parameters({hive::interface_of(first, 3s)}, current, true);
    case Operand::file:
    case Operand::other: break;
    }
    return {};
}

Words flags(const CommandLine& line)
{
    Words names;
    for (const auto& option : line.entries())
        for (const auto& name : option.long_names)
            names.push_back("--" + name);
    return names;
}

Words values_of(const std::optional<CommandLine::Entry>& option)
{
    if (!option)
        return {};
    return option->type == "KIND" ? hive::kinds() : option->values;
}

/// The K of `--kind K` or `--kind=K`; empty without it.
std::string kind_in(const Words& words)
{
    for (std::size_t i = 1; i + 1 < words.size(); ++i)
        if (words[i - 1] == "--kind")
            return words[i];
        else if (words[i].starts_with("--kind="))
            return words[i].substr(7);
    return {};
}

/// The values of an option in the form "--as=c".
Words values_behind_equals(const CommandLine& line, const std::string& current)
{
    const auto name = current.substr(0, current.find('='));
    Words words;
    for (const auto& value : values_of(line.option_with_value(name)))
        words.push_back(name + "=" + value);
    return words;
}

/// The values of the argument at this position, if known.
Words values_at(const CommandLine& line, std::size_t place)
{
    for (const auto& entry : line.entries())
        if (entry.positional && place-- == 0)
            return entry.values;
    return {};
}

Words candidates(const Words& words, Session& session)
{
    const auto all = verbs();
    if (words.size() < 2) {
        Words names;
        for (const auto& verb : all)
            if (!verb.group.empty())
                names.emplace_back(verb.name);
        return names;
    }
    const Verb* verb = verb_named(all, words[0]);
    if (!verb)
        return {};
    CommandLine line;
    Session unused;
    const Run run = declared(*verb, line, unused);
    const std::string& current = words.back();
    if (const auto option = line.option_with_value(words[words.size() - 2]))
        return values_of(option);
    if (current.starts_with('-'))
        return current.find('=') == std::string::npos ? flags(line) : values_behind_equals(line, current);
    Words before;
    for (std::size_t i = 1; i + 1 < words.size(); ++i)
        if (!words[i].starts_with('-') && !line.option_with_value(words[i - 1]))
            before.push_back(words[i]);
    if (const auto known = values_at(line, before.size()); !known.empty())
        return known;
    if (verb->operands.empty())
        return {};
    const auto place = std::min(before.size(), verb->operands.size() - 1);
    return operands(verb->operands[place], before.empty() ? "" : before.front(), kind_in(words), current, session);
}

int run(const Words& words, Session& session)
{
    Words fitting;
    try {
        fitting = candidates(words, session);
    } catch (const hive::Error&) {
        // The user is typing: if the swarm does not answer, print no completion and no error.
    }
    std::erase_if(fitting, [&](const std::string& word) { return !words.empty() && !word.starts_with(words.back()); });
    std::string text;
    for (const auto& word : fitting)
        text += word + "\n";
    write_out(session.json ? json_text(fitting) + "\n" : text);
    return exit_code::done;
}

void declare(CommandLine& line, Words& words)
{
    line.option("WORD", words, "the arguments after hivectl; the last one is incomplete");
}

}  // namespace

Verb verb()
{
    return {.name = "complete",
            .usage = "-- WORD...",
            .summary = "Lists completions of the last word; for the scripts of hivectl completion",
            .operands = {Operand::other},
            .declare = with(declare, run)};
}

}  // namespace hivectl::complete_verb
