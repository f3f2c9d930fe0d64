// Looks every 10 ms until the process itself answers to its name.
#include "launch.hpp"

#include "exit_code.hpp"
#include "format.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "places.hpp"
#include "session.hpp"
#include "status_line.hpp"
#include "table.hpp"
#include "targets.hpp"

#include <hive/name.hpp>
#include <hive/program.hpp>

#include <sstream>
#include <sys/wait.h>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

hive::BackgroundProcess start(Session& session, const LaunchPlan& plan, const std::filesystem::path& log)
{
    const auto run = hive::command_of(plan.kind);
    require_free(session.application(), plan.verb, plan.kind, plan.name);
    std::vector<std::string> words = run.arguments, environment = run.environment;
    words.insert(words.end(), {"--name", plan.name});
    words.insert(words.end(), plan.arguments.begin(), plan.arguments.end());
    environment.push_back("HIVE_HOME=" + session.home().string());
    return {run.program, words, environment, log, plan.life};
}

/// The name belongs to one drone of the swarm. Of one that does not answer from another machine only the place is
/// known, and that is forgotten: it may have been switched off for good.
bool holds(hive::Application& application, std::string_view verb, const hive::Place& place)
{
    if (!is_elsewhere(place) || !application.status(std::vector{place.drone}).at(0).error)
        return true;
    complain(verb, place.drone + " at " + place_text(place) + " " + answered_text(place) + " and does not answer now; "
                       + (place.announced ? "it is taken to be gone" : "that place is forgotten"));
    application.forget_place(place);
    return false;
}

}  // namespace

void require_free(hive::Application& application, std::string_view verb, const std::string& kind,
                  const std::string& name)
{
    hive::require_name(name, "drone");
    if (!runs(application, name))
        return;
    const auto place = application.place(name);
    if (!holds(application, verb, place))
        return;
    throw hive::Error(hive::Errc::name_taken,
                      name + " is running already" + (is_elsewhere(place) ? ", at " + place_text(place) : ""),
                      "stop it: hivectl stop " + name + ", or start another beside it: hivectl start " + kind + " --as "
                          + name + "-2");
}

Launch::Launch(Session& session, LaunchPlan plan)
    : session_(session), plan_(std::move(plan)), process_(start(session_, plan_, log()))
{
}

std::filesystem::path Launch::log() const { return session_.home() / (plan_.name + ".log"); }

/// Does the process itself answer to the name, and is it past its start?
bool Launch::ready()
{
    const auto answer = session_.application().status(std::vector{plan_.name + "@" + hive::Place::here}).at(0);
    return !answer.error && answer.status.pid == process_.pid() && answer.status.state != hive::State::starting;
}

std::optional<int> Launch::await(std::chrono::milliseconds limit)
{
    const interrupt::Deferred deferred;
    const auto end = std::chrono::steady_clock::now() + limit;
    const Waiting waiting(plan_.name + " to be ready");
    session_.application().timeout(500ms);
    while (!ready()) {
        if (const auto status = process_.ended()) {
            require_free(session_.application(), plan_.verb, plan_.kind, plan_.name);
            return died(*status);
        }
        const bool late = std::chrono::steady_clock::now() >= end;
        if (late || !interrupt::sleep(10ms))
            return give_up(late, limit);
    }
    was_ready_ = true;
    return std::nullopt;
}

int Launch::give_up(bool late, std::chrono::milliseconds limit)
{
    process_.end();
    if (!late)
        return interrupt::exit_code();
    complain(plan_.verb, plan_.name + " was not ready within " + duration_text(limit / 1us)
                             + " and was ended; allow more time: --timeout SECONDS; its log says:");
    show_last_words();
    return exit_code::timed_out;
}

int Launch::died(int status) const
{
    complain(plan_.verb, plan_.name + " "
                             + (was_ready_ ? hive::how_it_ended(status) : hive::how_its_start_ended(status))
                             + "; its log says:");
    show_last_words();
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    return code >= exit_code::usage && code <= exit_code::partly_done ? code : exit_code::failure;
}

void Launch::show_last_words() const
{
    const std::string text = process_.last_words(15);
    std::istringstream words(text.empty() ? "(nothing)" : text);
    for (std::string line; std::getline(words, line);)
        complain(plan_.verb, "  " + printable(line));
}

Removal::~Removal()
{
    launch_.process().end();
    std::error_code ignored;
    if (!runs(application_, launch_.name()))
        std::filesystem::remove(launch_.log(), ignored);
}

int as_first_free(const std::string& name, const std::function<int(const std::string&)>& call)
{
    for (int number = 1;; ++number)
        try {
            return call(number == 1 ? name : name + "-" + std::to_string(number));
        } catch (const hive::Error& error) {
            if (error.code() != hive::Errc::name_taken)
                throw;
        }
}

namespace {

void print_started(Session& session, const std::string& name, bool found)
{
    const auto status = session.application().status(name + "@" + hive::Place::here);
    Row row{{"drone", name},
            {"kind", status.kind},
            {"pid", status.pid},
            {"log", (session.home() / (name + ".log")).string()},
            {"places", status.places}};
    if (found)
        row.add("found", true);
    write_out(session.json ? row.json() + "\n" : name + "\n");
}

/// Waits until the drone that has the name here is ready; false: it never will be, or is of another kind.
bool found_here(Session& session, const LaunchPlan& plan)
{
    const auto end = std::chrono::steady_clock::now() + session.timeout(10s);
    const Waiting waiting(plan.name + " to be ready");
    do {
        const auto answer = session.application().status(std::vector{plan.name + "@" + hive::Place::here}).at(0);
        if (!answer.error && answer.status.state != hive::State::starting)
            return hive::is_of_kind(answer.status, plan.kind);
        if (answer.error && answer.error->code() == hive::Errc::not_found)
            return false;
    } while (std::chrono::steady_clock::now() < end && interrupt::sleep(10ms));
    return false;
}

int start_newly(Session& session, const LaunchPlan& plan)
{
    interrupt::defer_until_exit();  // a drone that runs and an exit code of 130 would contradict each other
    Launch launch(session, plan);
    if (const auto failure = launch.await(session.timeout(10s)))
        return *failure;
    print_started(session, plan.name, false);
    return exit_code::done;
}

}  // namespace

int start_in_background(Session& session, const LaunchPlan& plan, bool if_missing)
try {
    return start_newly(session, plan);
} catch (const hive::Error& error) {
    if (error.code() != hive::Errc::name_taken || !if_missing || !found_here(session, plan))
        throw;
    print_started(session, plan.name, true);
    return exit_code::done;
}

}  // namespace hivectl
