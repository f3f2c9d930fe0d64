// hivectl halt: makes drones stop taking events.
#include "../verbs.hpp"
#include "run/each_drone.hpp"

namespace hivectl::halt_verb {

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
            .declare = [](CommandLine& line, Session& session) {
                return for_each_drone(line, session, "halt", "halted", &hive::Application::halt);
            }};
}

}  // namespace hivectl::halt_verb
