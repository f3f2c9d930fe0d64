// hivectl stop: stops drones.
#include "../verbs.hpp"
#include "run/remote_verb.hpp"
#include "words/places.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <hive/name.hpp>

#include <optional>

namespace hivectl::stop_verb {
namespace {

struct Options {
    std::vector<std::string> names;
    bool all = false;
};

/// Running drones, and crashed ones with saved state.
std::vector<std::string> all_of(hive::Application& application)
{
    auto names = application.drones();
    add_new(names, application.remembered());
    return names;
}

std::vector<std::string> meant_by(const std::string& word, hive::Application& application)
{
    if (!is_glob(word) && runs(application, word))
        return {word};
    auto names = all_of(application);
    const auto nothing_fits = hive::no_such("no drone " + hive::in_quotes(word) + " runs or is remembered", word, names,
                                            "see what runs: hivectl ps");
    std::erase_if(names, [&](const std::string& name) { return !hive::matches_glob(word, name); });
    if (names.empty())
        throw nothing_fits;
    return names;
}

/// Drones started elsewhere, known only by announcement, must be stopped by name.
std::vector<std::string> all_of_our_own(hive::Application& application)
{
    auto names = all_of(application);
    std::erase_if(
        names, [&](const std::string& name) { return runs(application, name) && application.place(name).announced; });
    return names;
}

std::vector<std::string> meant_by(const Options& options, hive::Application& application, Outcome& outcome)
{
    std::vector<std::string> names;
    if (options.all)
        return all_of_our_own(application);
    for (const auto& word : options.names)
        outcome.attempt(word, [&] { add_new(names, meant_by(word, application)); });
    return names;
}

/// A drone to stop, and its place; none if it crashed.
struct Target {
    std::string name;
    std::optional<hive::Place> place;
};

std::vector<Target> targets_of(const std::vector<std::string>& names, hive::Application& application)
{
    std::vector<Target> targets;
    for (const auto& name : names)
        targets.push_back({name, runs(application, name) ? std::optional(application.place(name)) : std::nullopt});
    return targets;
}

/// A drone on another machine that does not answer has crashed or is disconnected: ssh may still reach it.
void stop_through_ssh(const Target& target, const hive::Error& error, Session& session)
{
    const bool silent = error.code() == hive::Errc::unreachable || error.code() == hive::Errc::timeout;
    if (!silent || !target.place || !is_elsewhere(*target.place) || target.place->announced)
        throw error;
    if (target.place->ssh.empty())
        throw hive::Error(error.code(), error.what(), "if it is gone for good: hivectl place remove " + target.name);
    const auto& drone = target.place->drone;
    const int code = run_there(session, *target.place, {"stop", drone}, drone + " to exit").exit_code;
    if (code == exit_code::done || code == exit_code::not_found)
        session.application().forget_place(*target.place);
    else
        throw hive::Error(error.code(), target.name + " could not be stopped on " + target.place->host,
                          "see why it does not answer: hivectl logs " + target.name);
}

void report(const Target& target, Session& session)
{
    if (session.json)
        write_out(Row{{target.place ? "stopped" : "forgotten", target.name}}.json() + "\n");
    else if (target.place)
        write_out(target.name + "\n");
    else
        complain("stop", target.name + " was not running; its saved state was discarded");
}

std::vector<hive::Answer> stop_together(const std::vector<std::string>& names, hive::Application& application)
{
    const Waiting waiting(names_text(names) + " to exit");
    return application.stop(names);
}

int run(const Options& options, Session& session)
{
    if (options.all != options.names.empty())
        throw hive::Error(hive::Errc::invalid_argument,
                          options.all ? "names and --all are exclusive" : "no drones given",
                          options.all ? "use one or the other" : "give names, or --all; see what runs: hivectl ps");
    Outcome outcome("stop");
    auto& application = session.application();
    const auto names = meant_by(options, application, outcome);
    const auto targets = targets_of(names, application);
    const auto answers = stop_together(names, application);
    for (std::size_t i = 0; i < targets.size(); ++i)
        outcome.request(targets[i].name, [&] {
            if (const auto* error = error_of(answers[i].result))
                stop_through_ssh(targets[i], *error, session);
            report(targets[i], session);
        });
    return outcome.exit_code();
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.names, "drones, or globs such as 'face-*'");
    line.flag("--all", options.all,
              "every drone on this machine and in hivectl place, but not those known only by an announcement; discards "
              "the state of crashed drones");
}

}  // namespace

Verb verb()
{
    return {.name = "stop",
            .group = "run drones",
            .usage = "NAME... | --all [options]",
            .summary = "Stops drones and waits until they have exited",
            .details = "Prints the names of the stopped drones. A stopped drone loses its connections and parameters. "
                       "Its receivers keep theirs: they wait for a drone of that name until hivectl disconnect. A "
                       "crashed drone would restore its connections and parameters on restart; stop discards them.",
            .examples = "hivectl stop face\n"
                        "hivectl stop 'face-*'\n"
                        "hivectl stop --all",
            .operands = {Operand::drone},
            .declare = with(declare, run)};
}

}  // namespace hivectl::stop_verb
