// hivectl start: runs a drone in the background and returns when it answers.
#include "../command_line.hpp"
#include "../launch.hpp"
#include "../python_file.hpp"
#include "../session.hpp"
#include "../settings.hpp"
#include "../verbs.hpp"

namespace hivectl {
namespace {

struct Options {
    std::string kind, name, on_exception, listen, log_level;
    std::vector<std::string> settings;
    bool insecure = false;
};

std::vector<std::string> arguments(const Options& options)
{
    std::vector<std::string> words;
    for (const auto& setting : options.settings)
        words.insert(words.end(), {"--set", setting});
    for (const auto& [flag, value] : {std::pair{"--on-exception", options.on_exception},
                                      {"--listen", options.listen},
                                      {"--log-level", options.log_level}})
        if (!value.empty())
            words.insert(words.end(), {flag, value});
    if (options.insecure)
        words.emplace_back("--insecure");
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
                "which drone: the program hive-KIND beside hivectl, in $HIVE_DRONE_PATH or in $PATH; or a file "
                "of Python, FILE.py, which $HIVE_PYTHON or python3 runs")
        .required();
    line.option("key=value", options->settings, "parameters to begin with");
    line.option("--as", options->name, "its name in the swarm (default: KIND, or FILE without .py)").type_name("NAME");
    line.option("--on-exception", options->on_exception,
                "when its code throws: skip the input (default), or halt until resumed")
        .type_name("skip|halt")
        .one_of({"skip", "halt"});
    line.option("--listen", options->listen, "also be reachable there: tcp://HOST:PORT").type_name("ADDRESS");
    line.flag("--insecure", options->insecure,
              "let --listen take peers without a key: only on a network that you trust wholly");
    line.option("--log-level", options->log_level,
                "how much it writes to its log: debug, info (default), warning, error or off")
        .type_name("LEVEL")
        .one_of({"debug", "info", "warning", "error", "off"});
    return [options, &session] {
        if (options->name.empty())
            options->name = is_python_file(options->kind) ? name_of_python_file(options->kind) : options->kind;
        return run(*options, session);
    };
}

}  // namespace

Verb start_verb()
{
    return {.name = "start",
            .group = "run drones",
            .usage = "KIND|FILE.py [--as NAME] [key=value ...] [options]",
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
