// hivectl schema: prints the JSON Schema of swarm files, for editors.
#include "../verbs.hpp"

#include <hive/swarm_plan.hpp>

namespace hivectl::schema_verb {
namespace {

int print()
{
    write_out(hive::swarm_schema());
    return exit_code::done;
}

}  // namespace

Verb verb()
{
    return {.name = "schema",
            .group = "a swarm from a file",
            .usage = "[options]",
            .summary = "Prints the JSON Schema of swarm files, for completion in editors",
            .details = "A file that starts with {\"$schema\": \"swarm.schema.json\", ... is completed and checked as "
                       "you type, in any editor that supports JSON Schema.",
            .examples = "hivectl schema > swarm.schema.json",
            .operands = {Operand::other},
            .declare = [](CommandLine&, Session&) { return print; }};
}

}  // namespace hivectl::schema_verb
