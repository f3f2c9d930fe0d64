// Finding the program, starting it, and waiting until it answers or has said why it does not.
#include "launch.hpp"

#include "background.hpp"
#include "exit_code.hpp"
#include "format.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "programs.hpp"
#include "session.hpp"
#include "settings.hpp"
#include "table.hpp"

#include <hive/name.hpp>

#include <algorithm>
#include <sstream>
#include <sys/wait.h>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

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

void require_free(Session& session, const Launch& launch)
{
    const auto running = session.application().drones();
    if (std::ranges::find(running, launch.name) != running.end())
        throw hive::Error(hive::Errc::name_taken, launch.name + " is running already; stop it: hivectl stop " + launch.name
                                                      + ", or start another beside it: hivectl start " + launch.kind + " --as " + launch.name + "-2");
}

std::vector<std::string> arguments(const Launch& launch)
{
    std::vector<std::string> words{"--name", launch.name};
    for (const auto& setting : launch.settings)
        words.insert(words.end(), {"--set", setting});
    for (const auto& [flag, value] : {std::pair{"--on-exception", launch.on_exception}, {"--listen", launch.listen}, {"--log-level", launch.log_level}})
        if (!value.empty())
            words.insert(words.end(), {flag, value});
    if (launch.insecure)
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

}  // namespace

int start_drone(const Launch& launch, Session& session)
{
    parse_settings(launch.settings);  // mistakes are found before anything is started
    const auto program = require_program(launch.kind);
    hive::require_name(launch.name, "drone");
    require_free(session, launch);
    const auto log = session.home() / (launch.name + ".log");
    BackgroundProcess process(program, arguments(launch), {"HIVE_HOME=" + session.home().string()}, log);
    if (const auto failure = await(session, launch.name, process, session.timeout(10s)))
        return *failure;
    const Row row{{"drone", launch.name}, {"kind", launch.kind}, {"pid", process.pid()}, {"log", log.string()}};
    write_out(session.json ? row.json() + "\n" : launch.name + "\n");
    return exit_code::done;
}

}  // namespace hivectl
