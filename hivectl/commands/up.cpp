// hivectl up: brings up the swarm of a file.
#include "../verbs.hpp"
#include "run/swarm_file.hpp"
#include "run/swarm_work.hpp"

#include <hive/swarm.hpp>

namespace hivectl::up_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    SwarmInput input;
    bool dry_run = false, stay = false;
};

void print(const std::vector<hive::SwarmStep>& steps, bool json)
{
    for (const auto& step : steps) {
        const auto what = std::string(token(step.what)), text = to_text(step);
        write_out(json ? Row{{"step", what}, {"drone", step.drone}, {"what", text}}.json() + "\n"
                       : what + " " + printable(text) + "\n");
    }
}

/// Supervises until Ctrl-C, which is the normal end.
void stay(hive::Swarm& swarm)
{
    swarm.stay([](const std::string& text) { complain_in_lines("up", text); },
               {.on_progress = {}, .cancelled = interrupt::requested});
}

int run(const Options& options, Session& session)
{
    const auto plan = read_plan("up", options.input, true);
    if (!plan)
        return exit_code::refused;
    hive::Swarm swarm(session.application(), *plan);
    if (options.dry_run) {
        const SwarmWork work("up");
        print(swarm.differences(work.watch()), session.json);
        return exit_code::done;
    }
    interrupt::defer_until_exit();
    const auto outcome = [&] {
        const SwarmWork work("up");
        return swarm.up(session.timeout(60s), work.watch());
    }();
    if (outcome.failures.empty())
        print(outcome.steps, session.json);
    else
        complain("up", outcome.remains.empty()
                           ? plan->name + " is unchanged, because:"
                           : plan->name + " was not brought up and could not be rolled back completely:");
    const bool all_done = outcome.failures.empty() && outcome.remains.empty()
                          && outcome.silent.empty();  // even if Ctrl-C was pressed afterwards
    const int code = all_done ? exit_code::done : complain_about("up", outcome);
    if (!options.stay || !outcome.failures.empty() || !outcome.remains.empty())
        return code;
    stay(swarm);
    return exit_code::done;
}

void declare(CommandLine& line, Options& options)
{
    line.option("FILE", options.input.file, "the swarm file; -: stdin").required();
    declare_variables(line, options.input);
    const auto dry_run = line.flag("--dry-run", options.dry_run, "only print what would be done");
    line.flag("--stay", options.stay,
              "keep running until Ctrl-C, and restart drones with \"restart\" in the file if they crash or hang, after "
              "0.1 s to 30 s; drones that hivectl down stops stay down until the next up")
        .excludes(dry_run);
}

}  // namespace

Verb verb()
{
    return {
        .name = "up",
        .group = "a swarm from a file",
        .usage = "FILE [--set NAME=VALUE ...] [--dry-run | --stay] [options]",
        .summary = "Starts, sets and connects all drones of a swarm file",
        .details =
            "Prints what it did. A running drone is changed where it differs from the file, and restarted if only a "
            "new process can have the change; what an earlier file of this swarm had and this one lacks is stopped, or "
            "reset to its default. A drone that another swarm or a user started is connected and otherwise left alone, "
            "unless it has \"change_if_shared\" in the file; stderr names it. So a second up does nothing. It is all "
            "or nothing: if a drone does not start or refuses a value, or on Ctrl-C, all changes are rolled back. A "
            "drone that does not answer in time, for example because its code hangs, does not block the others: stderr "
            "names it, and the exit code is 8. Of "
            "failures that differ only in names and numbers, stderr has the first 20; with --json all. The "
            "format is in libhive/docs/swarm-file.md; hivectl check checks a file without starting anything.",
        .examples = "hivectl up doorway.json\n"
                    "hivectl up doorway.json --dry-run\n"
                    "hivectl up doorway.json --set scale=1.2",
        .timeout = "for all drones to be ready (default 60)",
        .operands = {Operand::file},
        .declare = with(declare, run)};
}

}  // namespace hivectl::up_verb
