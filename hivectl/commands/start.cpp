// hivectl start: runs a drone in the background and returns when it answers.
#include "../command_line.hpp"
#include "../launch.hpp"
#include "../remote_start.hpp"
#include "../session.hpp"
#include "../settings.hpp"
#include "../verbs.hpp"

#include <hive/program.hpp>

namespace hivectl::start_verb {
namespace {

struct Options {
    std::string kind, name, on_exception, listen, advertise, key, log_level, on, swarm;
    std::vector<std::string> settings, connections, expected;
    bool if_missing = false, halted = false, insecure = false, no_announce = false, remote_operator = false;
};

/// The options that are handed on; to a drone here as to a hivectl elsewhere.
std::vector<std::string> handed_on(const Options& options)
{
    std::vector<std::string> words;
    for (const auto& [flag, value] : {std::pair{"--on-exception", options.on_exception},
                                      {"--listen", options.listen},
                                      {"--advertise", options.advertise},
                                      {"--key", options.key},
                                      {"--log-level", options.log_level},
                                      {"--swarm", options.swarm}})
        if (!value.empty())
            words.insert(words.end(), {flag, value});
    for (const auto& connection : options.connections)
        words.insert(words.end(), {"--connect", connection});
    for (const auto& receiver : options.expected)
        words.insert(words.end(), {"--expect", receiver});
    for (const auto& [flag, chosen] : {std::pair{"--halted", options.halted},
                                       {"--insecure", options.insecure},
                                       {"--no-announce", options.no_announce},
                                       {"--remote-operator", options.remote_operator}})
        if (chosen)
            words.emplace_back(flag);
    return words;
}

/// For the drone's program.
std::vector<std::string> arguments(const Options& options)
{
    auto words = handed_on(options);
    for (const auto& setting : options.settings)
        words.insert(words.end(), {"--set", setting});
    return words;
}

/// For the hivectl there: as here, but that the drone is met from other machines.
std::vector<std::string> words_for_other_machine(Options options)
{
    if (options.listen.empty())
        options.listen = "tcp://0.0.0.0";
    auto words = handed_on(options);
    words.insert(words.end(), options.settings.begin(), options.settings.end());
    return words;
}

int run(const Options& options, Session& session)
{
    parse_settings(options.settings);  // mistakes are found before anything is started
    if (options.on.empty())
        return start_in_background(session, {"start", options.kind, options.name, arguments(options)},
                                   options.if_missing);
    return start_remotely(
        session,
        {.ssh = options.on, .kind = options.kind, .name = options.name, .words = words_for_other_machine(options)});
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("KIND", options->kind,
                "which drone: the program hive-KIND beside hivectl, in $HIVE_DRONE_PATH or in $PATH; or a file "
                "of Python, FILE.py, which $HIVE_PYTHON or the first python3 that has its imports runs")
        .required();
    line.option("key=value", options->settings, "parameters to begin with");
    line.option("--as", options->name, "its name in the swarm (default: KIND, or FILE without .py)").type_name("NAME");
    const auto on = line.option("--on", options->on,
                                "start it on that machine, through ssh: HOST, USER@HOST, or a name of ssh's own")
                        .type_name("HOST");
    line.flag("--if-missing", options->if_missing,
              "a drone of this name and kind that runs here already is left as it is, and printed as if it was started")
        .excludes(on);
    line.option("--on-exception", options->on_exception,
                "when its code throws: skip the input (default), or halt until resumed")
        .type_name("skip|halt")
        .one_of({"skip", "halt"});
    line.option("--connect", options->connections,
                "receive from there as soon as the sender is there; may be repeated, and INPUT be left out where there "
                "is only one. OPTIONs: at=tcp://HOST:PORT, stream, notify, window=N, first_frame, share, group=NAME, "
                "lease=SECONDS, encoding=NAME")
        .type_name("[INPUT=]DRONE.OUTPUT[,OPTION...]")
        .one_each();
    line.option("--expect", options->expected,
                "wait for this receiver before emitting lossless events; may be repeated. OUTPUT may be omitted if "
                "there is only one. `hivectl disconnect` ends the wait")
        .type_name("[OUTPUT=]DRONE.INPUT[,group=NAME]")
        .one_each();
    line.flag("--halted", options->halted, "start it halted, so that everything can be connected first");
    line.option("--listen", options->listen,
                "also be reachable there: tcp://HOST:PORT, or tcp://HOST for a port from 7700 on (default with --on: "
                "tcp://0.0.0.0)")
        .type_name("ADDRESS");
    line.option("--advertise", options->advertise,
                "where other machines find it, if that is not where it listens: tcp://HOST or tcp://HOST:PORT")
        .type_name("ADDRESS");
    line.option("--key", options->key,
                "the swarm's key file, on the machine where it runs (default: $HIVE_KEY, or ~/.config/hive/swarm.key)")
        .type_name("FILE");
    line.flag("--insecure", options->insecure,
              "let --listen take peers without a key: only on a network that you trust wholly");
    line.flag("--no-announce", options->no_announce,
              "do not announce it on the local network when it listens there: who is told its place still finds it");
    line.flag("--remote-operator", options->remote_operator,
              "who has the swarm's key may also set over the network what concerns this machine: paths, URLs, logins");
    line.option("--swarm", options->swarm, "the swarm that it belongs to, whose hivectl down ends it (default: none)")
        .type_name("NAME");
    line.option("--log-level", options->log_level,
                "lowest level of its log lines: debug, info (default), warning, error or off")
        .type_name("LEVEL")
        .one_of({"debug", "info", "warning", "error", "off"});
    return [options, &session] {
        if (options->name.empty())
            options->name = hive::usual_name(options->kind);
        return run(*options, session);
    };
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
            .operands = {Operand::kind, Operand::other},
            .declare = declare};
}

}  // namespace hivectl::start_verb
