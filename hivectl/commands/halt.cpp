// hivectl halt: makes drones take nothing more.
#include "../each_drone.hpp"
#include "../verbs.hpp"

namespace hivectl {

Verb halt_verb()
{
    return {.name = "halt",
            .group = "when something goes wrong",
            .usage = "NAME... [options]",
            .summary = "Makes drones take nothing more until they are resumed",
            .details = "Prints the names. What they are working on is finished. Parameters can still be set, and ps, "
                       "get and describe still answer. To make a drone halt by itself when its code throws: hivectl "
                       "exceptions NAME --on-exception halt.",
            .examples = "hivectl halt face\n"
                        "hivectl halt 'face-*'",
            .operands = {Operand::drone},
            .declare = [](CommandLine& line, Session& session) {
                return for_each_drone(line, session, "halt", "halted", &hive::Application::halt);
            }};
}

}  // namespace hivectl
