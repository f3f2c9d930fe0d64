// hivectl halt: makes drones take nothing more.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../output.hpp"
#include "../session.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

namespace hivectl {
namespace {

int run(const std::vector<std::string>& names, Session& session)
{
    auto& application = session.application();
    Outcome outcome("halt");
    for (const auto& name : drones_named(application, names)) {
        try {
            application.halt(name);
            outcome.done();
            write_out(session.json ? Row{{"halted", name}}.json() + "\n" : name + "\n");
        } catch (const hive::Error& error) {
            outcome.failed(name, error);
        }
    }
    return outcome.exit_code();
}

Run declare(CLI::App& app, Session& session)
{
    auto names = std::make_shared<std::vector<std::string>>();
    app.add_option("NAME", *names, "drones, or globs such as 'face-*'")->required();
    return [names, &session] { return run(*names, session); };
}

}  // namespace

Verb halt_verb()
{
    return {.name = "halt",
            .group = "when something goes wrong",
            .usage = "NAME... [options]",
            .summary = "Makes drones take nothing more until they are resumed",
            .details = "Prints the names. What they are working on is finished. Parameters can still be set, and ps, get and describe still answer. To make a drone halt by itself when its code throws: hivectl exceptions NAME --on-exception halt.",
            .examples = "hivectl halt face\n"
                        "hivectl halt 'face-*'",
            .operands = {Operand::drone},
            .declare = declare};
}

}  // namespace hivectl
