// hivectl resume: makes halted drones continue.
#include "../each_drone.hpp"
#include "../verbs.hpp"

namespace hivectl::resume_verb {

Verb verb()
{
    return {.name = "resume",
            .group = "errors",
            .usage = "NAME... [options]",
            .summary = "Lets halted drones go on",
            .details = "Prints the names of the drones. It does not matter whether they halted because their code "
                       "threw or because of hivectl halt. What they do at the next exception does not change; hivectl "
                       "exceptions NAME --on-exception skip changes it.",
            .examples = "hivectl resume face\n"
                        "hivectl resume 'face-*'",
            .operands = {Operand::drone},
            .declare = [](CommandLine& line, Session& session) {
                return for_each_drone(line, session, "resume", "resumed", &hive::Application::resume);
            }};
}

}  // namespace hivectl::resume_verb
