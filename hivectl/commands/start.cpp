// hivectl start: runs a drone in the background and returns when it answers.
#include "../verbs.hpp"
#include "run/launch.hpp"
#include "words/settings.hpp"

#include <hive/connection_option.hpp>
#include <hive/program.hpp>

namespace hivectl::start_verb {
namespace {

struct Options {
    hive::DroneOrder order;
    std::string on;
    std::vector<std::string> settings;
    bool if_missing = false;
};

int run(const Options& options, Session& session)
{
    auto order = options.order;
    order.set = parse_settings(options.settings);
    if (order.name.empty())
        order.name = hive::usual_name(order.kind);
    auto wanted = start_options(session, "start", std::move(order), options.on);
    wanted.if_missing = options.if_missing;
    return start_in_background(session, wanted);
}

void declare(CommandLine& line, Options& options)
{
    line.option("KIND", options.order.kind,
                "the program hive-KIND next to hivectl, in $HIVE_DRONE_PATH or in $PATH; or a Python file, FILE.py, "
                "run by $HIVE_PYTHON or by the first python3 that has its imports")
        .required();
    line.option("key=value", options.settings, "initial parameters");
    line.option("--as", options.order.name, "its name in the swarm (default: KIND, or FILE without .py)")
        .type_name("NAME");
    line.option("--on", options.on,
                "start it on this machine over ssh: HOST, USER@HOST, or an ssh host alias; listens at tcp://0.0.0.0 "
                "without --listen")
        .type_name("HOST");
    line.flag("--if-missing", options.if_missing,
              "reuse a running drone of this name and kind, and print it as if it was started");
    line.option("--connect", options.order.connections,
                "receive from this output once the sender is up; repeatable; omit INPUT if there is only one. OPTIONs: "
                    + hive::connection_option_words())
        .type_name("[INPUT=]DRONE.OUTPUT[,OPTION...]")
        .one_each();
    line.option("--expect", options.order.expected,
                "wait for this receiver before emitting lossless events; repeatable. Omit OUTPUT if there is only one. "
                "`hivectl disconnect` ends the wait")
        .type_name("[OUTPUT=]DRONE.INPUT[,group=NAME]")
        .one_each();
    declare_fields(line, options.order);
    line.option("--swarm", options.order.swarm, "its swarm, which hivectl down stops (default: none)")
        .type_name("NAME");
}

}  // namespace

Verb verb()
{
    return {.name = "start",
            .group = "run drones",
            .usage = "KIND|FILE.py [--as NAME] [--on HOST] [key=value ...] [options]",
            .summary = "Starts a drone in the background, here or on another machine",
            .details = "Returns when the drone answers, and prints its name. Its output goes to NAME.log in the "
                       "runtime directory. If it exits instead of answering, hivectl shows the end of the log and "
                       "returns the drone's exit code. A drone keeps its port when it is restarted after a crash.\n\n"
                       "With --on HOST, the hivectl on that machine starts it, over ssh with your configuration; every "
                       "verb then finds it by name. The ssh connection stays open for a minute, for further commands. "
                       "FILE.py must already be there.",
            .examples = "hivectl start camera\n"
                        "hivectl start face --as face-2 scale=1.05 min_size=40",
            .timeout = "stop it if it does not answer in time (default 10)",
            .operands = {Operand::kind, Operand::setting_of_kind},
            .declare = with(declare, run)};
}

}  // namespace hivectl::start_verb
