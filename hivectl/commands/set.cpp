// hivectl set: changes parameters of one drone, or of many at once.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "run/remote_verb.hpp"
#include "words/places.hpp"
#include "words/settings.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <set>

namespace hivectl::set_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string target;
    std::vector<std::string> settings;
};

/// Runs the same command on the drone's machine, at its local socket: a user who can log in there is an operator.
int set_there(const hive::Place& place, const Options& options, Session& session)
{
    std::vector<std::string> words{"set", place.drone, "--timeout",
                                   std::to_string(std::max<std::int64_t>(1, session.timeout() / 1s))};
    if (session.json)
        words.emplace_back("--json");
    words.insert(words.end(), options.settings.begin(), options.settings.end());
    const auto result = run_there(session, place, words, place.drone + " to answer");
    write_out(result.out);
    return result.exit_code;
}

int set_one(const Options& options, const hive::Json& settings, Session& session)
try {
    const Waiting waiting(options.target + " to answer");
    const auto applied = session.application().set(options.target, settings);
    write_out(session.json ? json_text(applied) + "\n" : settings_text(applied));
    return exit_code::done;
} catch (const hive::Error& error) {
    if (error.code() == hive::Errc::not_permitted)
        if (const auto place = session.application().place(options.target); is_elsewhere(place) && !place.ssh.empty())
            return set_there(place, options, session);
    return exit_code_of_failure("set", options.target, error);
}

/// The exit code of a set that changed nothing: that of the cause, not that of the drones that were rolled back.
int exit_code_of_refusal(const std::vector<hive::Answer>& answers)
{
    complain("set", "no drone was changed");
    if (interrupt::requested())
        return interrupt::exit_code();
    std::set<int> causes;
    for (const auto& answer : answers)
        if (const auto* error = error_of(answer.result); error && exit_code_of(error->code()) != exit_code::refused)
            causes.insert(exit_code_of(error->code()));
    return causes.empty() ? exit_code::refused : causes.size() == 1 ? *causes.begin() : exit_code::failure;
}

int set_many(const Options& options, const hive::Json& settings, Session& session)
{
    interrupt::defer_until_exit();  // Ctrl-C after the commit must not report that nothing has changed
    auto& application = session.application();
    const Waiting waiting(options.target + " to answer");
    const auto result = application.set(application.find(options.target), settings, interrupt::requested);
    Outcome outcome("set");
    for (const auto& answer : result.answers)
        if (const auto* error = error_of(answer.result)) {
            outcome.failed(answer.drone, *error);
        } else {
            const auto& values = std::get<hive::Json>(answer.result);
            outcome.done();
            write_out(session.json ? Row{{"drone", answer.drone}, {"values", values}}.json() + "\n"
                                   : settings_text(answer.drone, values));
        }
    return result.changed == hive::SetResult::Changed::none ? exit_code_of_refusal(result.answers)
                                                            : outcome.exit_code();
}

int run(const Options& options, Session& session)
{
    const auto settings = parse_settings(options.settings);
    return is_glob(options.target) ? set_many(options, settings, session) : set_one(options, settings, session);
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.target, "a drone, or a glob such as 'face-*'").required();
    line.option("key=value", options.settings, "parameters and their new values").required();
}

}  // namespace

Verb verb()
{
    return {.name = "set",
            .group = "parameters",
            .usage = "NAME key=value... [options]",
            .summary = "Changes parameters of running drones",
            .details =
                "Returns once the drone has applied the values, and prints them: bare for one parameter of one drone, "
                "otherwise as key=value. All values are applied together or not at all. With a glob this holds across "
                "drones: each tries the values first, and if one refuses, or you press Ctrl-C before that, no drone is "
                "changed (exit code 5, or 130). If a drone dies while the change is being committed, it is reported as "
                "unknown (exit code 8, or 4 when no drone has confirmed). Paths, URLs and logins are set on the "
                "drone's own machine; for a single drone started with --on, hivectl does that over ssh. With --json an "
                "object of values; with a glob one {\"drone\", \"values\"} a line.",
            .examples = "hivectl set face scale=1.05 min_size=40\n"
                        "hivectl set 'face-*' scale=1.05",
            .operands = {Operand::drone, Operand::setting},
            .declare = with(declare, run)};
}

}  // namespace hivectl::set_verb
