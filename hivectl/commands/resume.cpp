// hivectl resume: makes halted drones continue.
#include "../verbs.hpp"
#include "run/each_drone.hpp"

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
            .declare = [](CommandLine& line, Session& session) {
                return for_each_drone(line, session, "resume", "resumed", &hive::Application::resume);
            }};
}

}  // namespace hivectl::resume_verb
