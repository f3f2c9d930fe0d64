// hivectl get: reads parameters.
#include "../verbs.hpp"
#include "words/settings.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

namespace hivectl::get_verb {
namespace {

struct Options {
    std::string target;
    std::vector<std::string> names;
};

int get_one(const Options& options, Session& session)
try {
    const Waiting waiting(options.target + " to answer");
    const auto values = session.application().get(options.target, options.names);
    if (session.json)
        write_out(json_text(values) + "\n");
    else if (options.names.size() == 1)
        write_out(settings_text(values));
    else
        for (const auto& [key, value] : values.items())
            write_out(bare(key) + "=" + bare(value) + "\n");
    return exit_code::done;
} catch (const hive::Error& error) {
    return exit_code_of_failure("get", options.target, error);
}

int get_many(const Options& options, Session& session)
{
    auto& application = session.application();
    Outcome outcome("get");
    const Waiting waiting(options.target + " to answer");
    for (const auto& answer : application.get(application.find(options.target), options.names)) {
        if (const auto* error = error_of(answer.result)) {
            outcome.failed(answer.drone, *error);
            continue;
        }
        const auto& values = std::get<hive::Json>(answer.result);
        outcome.done();
        write_out(session.json ? Row{{"drone", answer.drone}, {"values", values}}.json() + "\n"
                               : settings_text(answer.drone, values));
    }
    return outcome.exit_code();
}

int run(const Options& options, Session& session)
{
    return is_glob(options.target) ? get_many(options, session) : get_one(options, session);
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.target, "a drone, or a glob such as 'face-*'").required();
    line.option("PARAMETER", options.names, "which parameters (default: all)");
}

}  // namespace

Verb verb()
{
    return {.name = "get",
            .group = "parameters",
            .usage = "NAME [PARAMETER...] [options]",
            .summary = "Reads parameters",
            .details = "Prints a single parameter of one drone bare, several as key=value, and those of a glob after "
                       "the drone's name. Drones answer even while they are busy. With --json this prints an object of "
                       "values; with a glob, one object {\"drone\", \"values\"} per line.",
            .examples = "hivectl get face scale\n"
                        "hivectl get face\n"
                        "hivectl get 'face-*' scale",
            .operands = {Operand::drone, Operand::parameter},
            .declare = with(declare, run)};
}

}  // namespace hivectl::get_verb
