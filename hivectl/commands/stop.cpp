// hivectl stop: ends drones.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../output.hpp"
#include "../places.hpp"
#include "../remote_start.hpp"
#include "../session.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

#include <hive/name.hpp>

namespace hivectl::stop_verb {
namespace {

struct Options {
    std::vector<std::string> names;
    bool all = false;
};

/// Drones that run, and those that crashed and are remembered.
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

/// What somebody else started, and this home knows of by its announcement alone, is stopped by its name.
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
        try {
            add_new(names, meant_by(word, application));
        } catch (const hive::Error& error) {
            outcome.failed(word, error);
        }
    return names;
}

/// One on another machine that does not answer has crashed, or is cut off: ssh may get there all the same.
void stop_anywhere(const std::string& name, Session& session)
{
    auto& application = session.application();
    const auto place = runs(application, name) ? application.place(name) : hive::Place{};
    try {
        application.stop(name);
    } catch (const hive::Error& error) {
        const bool silent = error.code() == hive::Errc::unreachable || error.code() == hive::Errc::timeout;
        if (!is_elsewhere(place) || !silent)
            throw;
        if (place.announced)
            throw;
        if (place.ssh.empty())
            throw hive::Error(error.code(), error.what(), "if it is gone for good: hivectl place remove " + name);
        if (const int code = stop_remotely(session, place); code != exit_code::done && code != exit_code::not_found)
            throw hive::Error(error.code(), name + " could not be stopped on " + place.host,
                              "see why it does not answer: hivectl logs " + name);
    }
}

void stop(const std::string& name, Session& session)
{
    auto& application = session.application();
    const bool ran = runs(application, name);
    stop_anywhere(name, session);
    if (session.json)
        write_out(Row{{ran ? "stopped" : "forgotten", name}}.json() + "\n");
    else if (ran)
        write_out(name + "\n");
    else
        complain("stop", name + " did not run; what it was told before it crashed is forgotten");
}

int run(const Options& options, Session& session)
{
    if (options.all != options.names.empty())
        throw hive::Error(
            hive::Errc::invalid_argument, options.all ? "both names and --all are given" : "no drones are named",
            options.all ? "give the one or the other" : "give names, or --all; see what runs: hivectl ps");
    Outcome outcome("stop");
    for (const auto& name : meant_by(options, session.application(), outcome)) {
        try {
            stop(name, session);
            outcome.done();
        } catch (const hive::Error& error) {
            outcome.failed(name, error);
        }
    }
    return outcome.exit_code();
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->names, "drones, or globs such as 'face-*'");
    line.flag(
        "--all", options->all,
        "every drone of this machine and of the list of places (hivectl place), but none that only announces itself "
        "on the local network; those that crashed are forgotten");
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb verb()
{
    return {.name = "stop",
            .group = "run drones",
            .usage = "NAME... | --all [options]",
            .summary = "Stops drones, and returns when they are gone",
            .details = "Prints the names of the drones that ended. A drone that is stopped forgets its connections and "
                       "the parameters that it was given. Its receivers keep their connections: they wait for a drone "
                       "of that name until hivectl disconnect. A drone that crashed would get its connections and "
                       "parameters back when it is started again; stop makes hivectl forget them.",
            .examples = "hivectl stop face\n"
                        "hivectl stop 'face-*'\n"
                        "hivectl stop --all",
            .operands = {Operand::drone},
            .declare = declare};
}

}  // namespace hivectl::stop_verb
