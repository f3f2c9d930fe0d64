// hivectl resume: lets halted drones go on.
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
    Outcome outcome("resume");
    for (const auto& name : drones_named(application, names)) {
        try {
            application.resume(name);
            outcome.done();
            write_out(session.json ? Row{{"resumed", name}}.json() + "\n" : name + "\n");
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

Verb resume_verb()
{
    return {.name = "resume",
            .group = "when something goes wrong",
            .usage = "NAME... [options]",
            .summary = "Lets halted drones go on",
            .details = "Prints the names. Whether they halted because their code threw or by hivectl halt. What happens at the next exception stays as it is; change it with hivectl exceptions NAME --on-exception skip.",
            .examples = "hivectl resume face\n"
                        "hivectl resume 'face-*'",
            .operands = {Operand::drone},
            .declare = declare};
}

}  // namespace hivectl
