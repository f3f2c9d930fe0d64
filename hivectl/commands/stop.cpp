// hivectl stop: ends drones.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../output.hpp"
#include "../session.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

namespace hivectl {
namespace {

struct Options {
    std::vector<std::string> names;
    bool all = false;
};

int run(const Options& options, Session& session)
{
    if (options.all != options.names.empty())
        throw hive::Error(hive::Errc::invalid_argument, options.all ? "give names or --all, not both" : "which drones? give names, or --all; see what runs: hivectl ps");
    auto& application = session.application();
    Outcome outcome("stop");
    for (const auto& name : options.all ? application.drones() : drones_named(application, options.names, outcome)) {
        try {
            application.stop(name);
            outcome.done();
            write_out(session.json ? Row{{"stopped", name}}.json() + "\n" : name + "\n");
        } catch (const hive::Error& error) {
            outcome.failed(name, error);
        }
    }
    return outcome.exit_code();
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->names, "drones, or globs such as 'face-*'");
    line.flag("--all", options->all, "every drone that runs on this machine");
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb stop_verb()
{
    return {.name = "stop",
            .group = "run drones",
            .usage = "NAME... | --all [options]",
            .summary = "Ends drones; returns when they are gone",
            .details = "Prints the names of those that ended. A stopped drone forgets the connections and parameters that it was "
                       "told; one that crashed gets them back when it is started again.",
            .examples = "hivectl stop face\n"
                        "hivectl stop 'face-*'\n"
                        "hivectl stop --all",
            .operands = {Operand::drone},
            .declare = declare};
}

}  // namespace hivectl
