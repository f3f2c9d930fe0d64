// hivectl halt and resume: make drones stop taking events, and continue.
#include "../verbs.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

namespace hivectl::halt_verb {
namespace {

using Names = std::vector<std::string>;

/// @param done  the outcome, as a key of --json
int request_each(const Names& names, Session& session, std::string_view verb, const std::string& done,
                 void (hive::Application::*action)(const std::string&))
{
    auto& application = session.application();
    Outcome outcome(verb);
    for (const auto& name : drones_named(application, names, outcome))
        outcome.request(name, [&] {
            const Waiting waiting(name + " to answer");
            (application.*action)(name);
            write_out(session.json ? Row{{done, name}}.json() + "\n" : name + "\n");
        });
    return outcome.exit_code();
}

int halt(const Names& names, Session& session)
{
    return request_each(names, session, "halt", "halted", &hive::Application::halt);
}

int resume(const Names& names, Session& session)
{
    return request_each(names, session, "resume", "resumed", &hive::Application::resume);
}

void declare(CommandLine& line, Names& names)
{
    line.option("NAME", names, "drones, or globs such as 'face-*'").required();
}

}  // namespace

Verb verb()
{
    return {.name = "halt",
            .group = "errors",
            .usage = "NAME... [options]",
            .summary = "Makes drones accept no events until they are resumed",
            .details = "Prints the names of the drones. They finish their current event. Parameters can still be set, "
                       "and ps, get and describe still work. To halt a drone automatically when its code throws, use "
                       "hivectl exceptions NAME --on-exception halt.",
            .examples = "hivectl halt face\n"
                        "hivectl halt 'face-*'",
            .operands = {Operand::drone},
            .declare = with(declare, halt)};
}

}  // namespace hivectl::halt_verb

namespace hivectl::resume_verb {

Verb verb()
{
    return {.name = "resume",
            .group = "errors",
            .usage = "NAME... [options]",
            .summary = "Resumes halted drones",
            .details = "Prints the names of the drones. Resumes drones that halted at an exception or by hivectl halt. "
                       "The exception policy stays; hivectl exceptions NAME --on-exception skip changes it.",
            .examples = "hivectl resume face\n"
                        "hivectl resume 'face-*'",
            .operands = {Operand::drone},
            .declare = with(halt_verb::declare, halt_verb::resume)};
}

}  // namespace hivectl::resume_verb
