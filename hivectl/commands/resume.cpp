// hivectl resume: lets halted drones go on.
#include "../each_drone.hpp"
#include "../verbs.hpp"

namespace hivectl {

Verb resume_verb()
{
    return {.name = "resume",
            .group = "when something goes wrong",
            .usage = "NAME... [options]",
            .summary = "Lets halted drones go on",
            .details =
                "Prints the names. Whether they halted because their code threw or by hivectl halt. What happens at "
                "the next exception stays as it is; change it with hivectl exceptions NAME --on-exception skip.",
            .examples = "hivectl resume face\n"
                        "hivectl resume 'face-*'",
            .operands = {Operand::drone},
            .declare = [](CommandLine& line, Session& session) {
                return for_each_drone(line, session, "resume", "resumed", &hive::Application::resume);
            }};
}

}  // namespace hivectl
