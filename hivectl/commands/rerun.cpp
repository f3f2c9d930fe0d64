// hivectl rerun: feeds the inputs at which a drone failed to a fresh drone.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../format.hpp"
#include "../interrupt.hpp"
#include "../kept_inputs.hpp"
#include "../output.hpp"
#include "../session.hpp"
#include "../settings.hpp"
#include "../status_line.hpp"
#include "../table.hpp"
#include "../verbs.hpp"

#include <hive/rerun.hpp>

#include <algorithm>
#include <sstream>

namespace hivectl::rerun_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string name, kind, program, under;
    std::vector<std::string> words;
};

std::vector<std::string> words_of(const std::string& text)
{
    std::istringstream in(text);
    std::vector<std::string> words;
    for (std::string word; in >> word;)
        words.push_back(word);
    return words;
}

/// Takes the number out of the arguments, if there is one; the others are settings.
std::optional<std::string> taken_number(std::vector<std::string>& words)
{
    const auto found = std::ranges::find_if(words, [](const auto& word) { return word.find('=') == word.npos; });
    if (found == words.end())
        return std::nullopt;
    const auto number = *found;
    words.erase(found);
    return number;
}

hive::KeptFailure failure_meant(Session& session, const std::string& drone, const std::optional<std::string>& number)
{
    const auto failures = session.application().failures(drone, true);
    if (failures.empty())
        throw hive::Error(hive::Errc::not_found, "no input that " + printable(drone) + " failed at is kept here",
                          "see what is: hivectl exceptions");
    const auto found = number ? std::ranges::find(failures, *number,
                                                  [](const auto& failure) { return std::to_string(failure.number); })
                              : failures.end() - 1;
    if (found != failures.end())
        return *found;
    std::string kept;
    for (const auto& failure : failures)
        kept += (kept.empty() ? "" : ", ") + std::to_string(failure.number);
    throw hive::Error(hive::Errc::not_found,
                      "of " + printable(drone) + " no failure " + printable(*number) + " is kept, but " + kept,
                      "see them: hivectl exceptions " + printable(drone));
}

std::string sentence(const hive::KeptFailure& failure, const hive::Rerun& result, const std::string& limit)
{
    const auto& drone = failure.drone;
    switch (result.outcome) {
    case hive::Rerun::Outcome::passed: return drone + " did not fail: emitted " + count_text(result.emitted, "event");
    case hive::Rerun::Outcome::threw: return drone + " threw: " + result.code + ": " + result.text;
    case hive::Rerun::Outcome::died: return drone + " died: " + result.text;
    case hive::Rerun::Outcome::hung: break;
    }
    return drone + " had not finished after " + limit + " and was killed";
}

int run(const Options& options, Session& session)
{
    auto words = options.words;
    const auto number = taken_number(words);
    const auto failure = failure_meant(session, options.name, number);
    const auto under = words_of(options.under);
    const auto limit = session.timeout(30s);
    const interrupt::Deferred deferred;
    std::optional<Waiting> waiting;
    if (under.empty())
        waiting.emplace("a fresh " + failure.drone + " to take failure " + std::to_string(failure.number));
    const auto result =
        hive::rerun(session.application(), failure,
                    {.kind = options.kind,
                     .program = options.program,
                     .set = parse_settings(words),
                     .under = under,
                     .limit = limit,
                     // ignored: Ctrl-C is for the debugger
                     .cancelled = [attached = !under.empty()] { return !attached && interrupt::requested(); }});
    waiting.reset();
    const bool passed = result.outcome == hive::Rerun::Outcome::passed;
    if (session.json)
        write_out(failure_row(failure)
                      .add("outcome", hive::token(result.outcome))
                      .add("rerun_code", result.code)
                      .add("rerun_text", result.text)
                      .add("emitted", result.emitted)
                      .add("log", result.log)
                      .json()
                  + "\n");
    else
        write_out(printable(sentence(failure, result, hive::duration_text(limit.count() * 1000))) + "\n");
    if (!session.json && !passed && !result.log.empty())
        write_error(result.log);
    return passed ? exit_code::done : exit_code::found;
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->name, "a drone that failed, running or not").required();
    line.option("words", options->words,
                "NO: number of the failure in hivectl exceptions (default: the newest); key=value: parameters of the "
                "new drone, in addition to those of NAME");
    line.option("--kind", options->kind, "KIND of the new drone, or a Python file, FILE.py (default: that of NAME)")
        .type_name("KIND");
    line.option("--program", options->program, "run this program instead, such as another build").type_name("PATH");
    line.option("--under", options->under,
                "run the drone under this command at this terminal, such as \"gdb --args\" or \"valgrind\", without "
                "--timeout; it gets the input once it is ready")
        .type_name("WORDS");
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb verb()
{
    return {.name = "rerun",
            .group = "errors",
            .usage = "NAME [NO] [key=value ...] [--program PATH] [--under \"gdb --args\"] [options]",
            .summary = "Reruns the input that a drone failed at in a new drone",
            .details =
                "The new drone has the program and the parameters that NAME has, or had before it crashed. It runs "
                "outside of the swarm, in its own directory, without connections, and exits with hivectl. It gets the "
                "kept events at the inputs where NAME had them; after a crash, all that the senders kept. hivectl "
                "reports the outcome and, if the drone failed again, prints the end of its log.\n\n"
                "The exit code is 0 if the drone did not fail, and 9 if it threw, crashed or did not finish in time.",
            .examples = "hivectl rerun face\n"
                        "hivectl rerun face 3 --under \"gdb --args\"\n"
                        "hivectl rerun face 3 --program build/debug/bin/hive-face scale=1.2",
            .timeout = "how long the drone may take to become ready, and then to finish (default 30)",
            .operands = {Operand::failed_drone, Operand::other},
            .declare = declare};
}

}  // namespace hivectl::rerun_verb
