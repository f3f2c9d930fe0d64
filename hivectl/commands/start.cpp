// hivectl start: runs a drone in the background and returns when it answers.
#include "../command_line.hpp"
#include "../launch.hpp"
#include "../session.hpp"
#include "../settings.hpp"
#include "../verbs.hpp"

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

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("KIND", options->order.kind,
                "which drone: the program hive-KIND beside hivectl, in $HIVE_DRONE_PATH or in $PATH; or a file "
                "of Python, FILE.py, which $HIVE_PYTHON or the first python3 that has its imports runs")
        .required();
    line.option("key=value", options->settings, "parameters to begin with");
    line.option("--as", options->order.name, "its name in the swarm (default: KIND, or FILE without .py)")
        .type_name("NAME");
    line.option("--on", options->on,
                "start it on that machine, through ssh: HOST, USER@HOST, or a name of ssh's own; it then listens at "
                "tcp://0.0.0.0 unless --listen says otherwise")
        .type_name("HOST");
    line.flag(
        "--if-missing", options->if_missing,
        "a drone of this name and kind that runs there already is left as it is, and printed as if it was started");
    line.option("--connect", options->order.connections,
                "receive from there as soon as the sender is there; may be repeated, and INPUT be left out where there "
                "is only one. OPTIONs: "
                    + hive::connection_option_words())
        .type_name("[INPUT=]DRONE.OUTPUT[,OPTION...]")
        .one_each();
    line.option("--expect", options->order.expected,
                "wait for this receiver before emitting lossless events; may be repeated. OUTPUT may be omitted if "
                "there is only one. `hivectl disconnect` ends the wait")
        .type_name("[OUTPUT=]DRONE.INPUT[,group=NAME]")
        .one_each();
    declare_fields(line, options->order);
    line.option("--swarm", options->order.swarm,
                "the swarm that it belongs to, whose hivectl down ends it (default: none)")
        .type_name("NAME");
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb verb()
{
    return {.name = "start",
            .group = "run drones",
            .usage = "KIND|FILE.py [--as NAME] [--on HOST] [key=value ...] [options]",
            .summary = "Starts a drone in the background, here or on another machine",
            .details =
                "Returns when the drone answers, and prints its name. Its output goes to NAME.log in the "
                "directory where drones meet. If it ends instead of answering, hivectl shows the last lines of "
                "the log and exits with the drone's exit code. A drone keeps the port at which it listens when "
                "it is started again after a crash.\n\n"
                "With --on HOST it is started there, by the hivectl of that machine, through ssh as you have "
                "set it up; from then on every verb finds it by its name. The connection of ssh is kept open for "
                "a minute, for the commands that follow. A FILE.py has to be there already.",
            .examples = "hivectl start camera\n"
                        "hivectl start face --as face-2 scale=1.05 min_size=40",
            .timeout = "end it if it does not answer within this long (default 10)",
            .operands = {Operand::kind, Operand::setting_of_kind},
            .declare = declare};
}

}  // namespace hivectl::start_verb
