// Creates the list of verbs, and finds one by name.
#include "verbs.hpp"

#include <algorithm>

namespace hivectl {

std::vector<Verb> verbs()
{
#define HIVECTL_CALL(name) name##_verb::verb(),
    return {HIVECTL_VERBS(HIVECTL_CALL)};
#undef HIVECTL_CALL
}

Run declared(const Verb& verb, CommandLine& line, Session& session)
{
    const Run run = verb.declare(line, session);
    line.flag("--json", session.json, "print JSON instead of text; one object per line for streams");
    if (verb.table)
        line.flag("--wide", session.wide, "print tables as wide as needed, not cut to the terminal");
    line.option("--timeout", session.timeout_s, std::string(verb.timeout)).type_name("SECONDS").seconds();
    return run;
}

const Verb* verb_named(const std::vector<Verb>& all, std::string_view name)
{
    const auto found = std::ranges::find_if(
        all, [&](const Verb& verb) { return verb.name == name || (!name.empty() && verb.alias == name); });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace hivectl
