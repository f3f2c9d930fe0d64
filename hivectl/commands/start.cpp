// hivectl start: runs a drone in the background and returns when it answers.
#include "../background.hpp"
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../format.hpp"
#include "../interrupt.hpp"
#include "../output.hpp"
#include "../programs.hpp"
#include "../session.hpp"
#include "../settings.hpp"
#include "../table.hpp"
#include "../verbs.hpp"

#include <hive/name.hpp>

#include <sys/wait.h>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string kind, name, on_exception, listen, log_level;
    std::vector<std::string> settings;
    bool insecure = false;
};

std::filesystem::path require_program(const std::string& kind)
{
    hive::require_name(kind, "kind");
    if (const auto program = program_of(kind))
        return *program;
    const auto known = kinds();
    std::string list;
    for (const auto& one : known)
        list += (list.empty() ? "" : ", ") + one;
    const std::string near = hive::nearest(kind, known);
    throw hive::Error(hive::Errc::not_found, "there is no program hive-" + kind + " beside hivectl, in $HIVE_DRONE_PATH or in $PATH; "
                                                 + (near.empty() ? "" : "did you mean " + near + "? ") + "kinds found: "
                                                 + (list.empty() ? "none" : list));
}

void require_free(Session& session, const Options& options)
{
    const auto running = session.application().drones();
    if (std::ranges::find(running, options.name) != running.end())
        throw hive::Error(hive::Errc::name_taken, options.name + " is running already; stop it: hivectl stop " + options.name
                                                      + ", or start another beside it: hivectl start " + options.kind + " --as " + options.name + "-2");
}

std::vector<std::string> arguments(const Options& options)
{
    std::vector<std::string> words{"--name", options.name};
    for (const auto& setting : options.settings)
        words.insert(words.end(), {"--set", setting});
    for (const auto& [flag, value] : {std::pair{"--on-exception", options.on_exception}, {"--listen", options.listen}, {"--log-level", options.log_level}})
        if (!value.empty())
            words.insert(words.end(), {flag, value});
    if (options.insecure)
        words.emplace_back("--insecure");
    return words;
}

void show_last_words(const BackgroundProcess& process)
{
    const std::string text = process.last_words(15);
    std::istringstream words(text.empty() ? "(nothing)" : text);
    for (std::string line; std::getline(words, line);)
        complain("start", "  " + printable(line));
}

/// Reports a drone that ended instead of answering. Its exit code is ours when it is one of the table.
int died(const std::string& name, BackgroundProcess& process, int status)
{
    const std::string how = WIFSIGNALED(status) ? "was killed by signal " + std::to_string(WTERMSIG(status))
                                                : "ended with exit code " + std::to_string(WEXITSTATUS(status));
    complain("start", name + " " + how + " before it was ready; its log says:");
    show_last_words(process);
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    return code >= exit_code::usage && code <= exit_code::partly_done ? code : exit_code::failure;
}

/// Does the process itself answer to the name, and is it past its start?
bool ready(Session& session, const std::string& name, pid_t pid)
{
    const auto answer = session.application().status(std::vector{name}).at(0);
    return !answer.error && count_in(answer.result, "pid") == pid && text_in(answer.result, "state") != "starting";
}

/// Waits until it is ready; the exit code if it never will be.
std::optional<int> await(Session& session, const std::string& name, BackgroundProcess& process, std::chrono::milliseconds limit)
{
    const interrupt::Deferred deferred;
    const auto end = std::chrono::steady_clock::now() + limit;
    session.application().timeout(500ms);
    while (!ready(session, name, process.pid())) {
        if (const auto status = process.ended())
            return died(name, process, *status);
        const bool late = std::chrono::steady_clock::now() >= end;
        if (late || !interrupt::sleep(10ms)) {
            process.end();
            if (late) {
                complain("start", name + " was not ready within " + duration_text(limit / 1us) + " and was ended; allow more time: --timeout SECONDS; its log says:");
                show_last_words(process);
            }
            return late ? exit_code::timed_out : exit_code::interrupted;
        }
    }
    return std::nullopt;
}

int run(const Options& options, Session& session)
{
    parse_settings(options.settings);  // mistakes are found before anything is started
    const auto program = require_program(options.kind);
    hive::require_name(options.name, "drone");
    require_free(session, options);
    const auto log = session.home() / (options.name + ".log");
    BackgroundProcess process(program, arguments(options), {"HIVE_HOME=" + session.home().string()}, log);
    if (const auto failure = await(session, options.name, process, session.timeout(10s)))
        return *failure;
    const Row row{{"drone", options.name}, {"kind", options.kind}, {"pid", process.pid()}, {"log", log.string()}};
    write_out(session.json ? row.json() + "\n" : options.name + "\n");
    return exit_code::done;
}

Run declare(CLI::App& app, Session& session)
{
    auto options = std::make_shared<Options>();
    app.add_option("KIND", options->kind, "which drone: the program hive-KIND beside hivectl, in $HIVE_DRONE_PATH or in $PATH")->required();
    app.add_option("key=value", options->settings, "parameters to begin with");
    app.add_option("--as", options->name, "its name in the swarm (default: KIND)")->type_name("NAME");
    app.add_option("--on-exception", options->on_exception, "when its code throws: skip the input (default), or halt until resumed")
        ->type_name("skip|halt")->check(CLI::IsMember({"skip", "halt"}));
    app.add_option("--listen", options->listen, "also be reachable there: tcp://HOST:PORT")->type_name("ADDRESS");
    app.add_flag("--insecure", options->insecure, "let --listen take peers without a key: only on a network that you trust wholly");
    app.add_option("--log-level", options->log_level, "how much it writes to its log: debug, info (default), warning, error or off")
        ->type_name("LEVEL")->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}));
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
            .summary = "Runs a drone in the background; returns when it answers",
            .details = "Prints its name. What it says goes to NAME.log in the directory where drones meet. If it ends "
                       "instead of answering, the last lines of its log are shown and its exit code is passed on.",
            .examples = "hivectl start camera\n"
                        "hivectl start face --as face-2 scale=1.05 min=40",
            .timeout = "end it if it does not answer within this long (default 10)",
            .operands = {Operand::kind, Operand::other},
            .declare = declare};
}

}  // namespace hivectl
