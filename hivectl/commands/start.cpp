// hivectl start: runs a drone in the background and returns when it answers.
#include "../command_line.hpp"
#include "../launch.hpp"
#include "../session.hpp"
#include "../settings.hpp"
#include "../verbs.hpp"

namespace hivectl {
namespace {

struct Options {
    std::string kind, name, on_exception, listen, key, log_level;
    std::vector<std::string> settings;
    bool halted = false, insecure = false, remote_operator = false;
};

std::vector<std::string> arguments(const Options& options)
{
    std::vector<std::string> words;
    for (const auto& setting : options.settings)
        words.insert(words.end(), {"--set", setting});
    for (const auto& [flag, value] : {std::pair{"--on-exception", options.on_exception},
                                      {"--listen", options.listen},
                                      {"--key", options.key},
                                      {"--log-level", options.log_level}})
        if (!value.empty())
            words.insert(words.end(), {flag, value});
    if (options.halted)
        words.emplace_back("--halted");
    if (options.insecure)
        words.emplace_back("--insecure");
    if (options.remote_operator)
        words.emplace_back("--remote-operator");
    return words;
}

int run(const Options& options, Session& session)
{
    parse_settings(options.settings);  // mistakes are found before anything is started
    return start_in_background(session, {"start", options.kind, options.name, arguments(options)});
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("KIND", options->kind,
                "which drone: the program hive-KIND beside hivectl, in $HIVE_DRONE_PATH or in $PATH")
        .required();
    line.option("key=value", options->settings, "parameters to begin with");
    line.option("--as", options->name, "its name in the swarm (default: KIND)").type_name("NAME");
    line.option("--on-exception", options->on_exception,
                "when its code throws: skip the input (default), or halt until resumed")
        .type_name("skip|halt")
        .one_of({"skip", "halt"});
    line.flag("--halted", options->halted, "start it halted, so that everything can be connected first");
    line.option("--listen", options->listen, "also be reachable there: tcp://HOST:PORT").type_name("ADDRESS");
    line.option("--key", options->key, "the swarm's key file (default: $HIVE_KEY, or ~/.config/hive/swarm.key)")
        .type_name("FILE");
    line.flag("--insecure", options->insecure,
              "let --listen take peers without a key: only on a network that you trust wholly");
    line.flag("--remote-operator", options->remote_operator,
              "who has the swarm's key may also set over the network what concerns this machine: paths, URLs, logins");
    line.option("--log-level", options->log_level,
                "how much it writes to its log: debug, info (default), warning, error or off")
        .type_name("LEVEL")
        .one_of({"debug", "info", "warning", "error", "off"});
    return [options, &session] {
        if (options->name.empty())
            options->name = options->kind;
        return run(*options, session);
    };
}

}  // namespace

Verb start_verb()
{
    return {.name = "start",
            .group = "run drones",
            .usage = "KIND [--as NAME] [key=value ...] [options]",
            .summary = "Starts a drone in the background",
            .details = "Returns when the drone answers, and prints its name. Its output goes to NAME.log in the "
                       "directory where drones meet. If it ends instead of answering, hivectl shows the last lines of "
                       "the log and exits with the drone's exit code.",
            .examples = "hivectl start camera\n"
                        "hivectl start face --as face-2 scale=1.05 min_size=40",
            .timeout = "end it if it does not answer within this long (default 10)",
            .operands = {Operand::kind, Operand::other},
            .declare = declare};
}

}  // namespace hivectl
