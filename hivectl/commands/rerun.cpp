// hivectl rerun: feeds the inputs at which a drone failed to a fresh drone.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "run/kept_inputs.hpp"
#include "words/format.hpp"
#include "words/settings.hpp"
#include "words/status_line.hpp"

#include <hive/rerun.hpp>

#include <algorithm>
#include <charconv>
#include <sstream>

namespace hivectl::rerun_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string name, kind, program, under, on, save;
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

/// Takes the number out of the arguments, if there is one; the others are settings. 0: the newest.
std::int64_t taken_number(std::vector<std::string>& words)
{
    const auto found = std::ranges::find_if(words, [](const auto& word) { return word.find('=') == word.npos; });
    if (found == words.end())
        return 0;
    const auto word = *found;
    words.erase(found);
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || number < 1)
        throw hive::Error(hive::Errc::invalid_argument, printable(word) + " is not the number of a failure",
                          "see them: hivectl exceptions");
    return number;
}

/// Throws for arguments that would have no effect.
void require_used(const Options& options, std::int64_t number, const std::vector<std::string>& settings)
{
    using hive::Errc, hive::Error;
    if (hive::is_failure_file(options.name) && number > 0)
        throw Error(Errc::invalid_argument, printable(options.name) + " is a file, which has one failure",
                    "leave out the number");
    if (hive::is_failure_file(options.name) && !options.on.empty())
        throw Error(Errc::invalid_argument, printable(options.name) + " is a file of this machine", "leave out --on");
    if (!options.save.empty() && !settings.empty())
        throw Error(Errc::invalid_argument, "--save runs nothing, so " + printable(settings.front()) + " has no effect",
                    "give it when you rerun the file");
}

hive::KeptFailure failure_meant(const Options& options, std::int64_t number, Session& session)
{
    const Waiting waiting("the failure of " + printable(options.name));
    constexpr auto for_ssh = 12s;
    return hive::find_failure(session.application(), {.drone = options.name,
                                                      .number = number,
                                                      .on = options.on,
                                                      .limit = session.timeout(30s) + for_ssh,
                                                      .cancelled = interrupt::requested});
}

int save(const hive::KeptFailure& failure, const Options& options, Session& session)
{
    const auto bytes = hive::failure_file(session.application(), failure);
    if (options.save == "-") {
        write_out(bytes);
        return exit_code::done;
    }
    write_new(options.save, bytes);
    auto row = failure_row(failure);
    write_out(session.json ? row.add("file", options.save).json() + "\n" : printable(options.save) + "\n");
    return exit_code::done;
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
    require_used(options, number, words);
    const interrupt::Deferred deferred;
    const auto failure = failure_meant(options, number, session);
    if (!options.save.empty())
        return save(failure, options, session);
    const auto under = words_of(options.under);
    const auto limit = session.timeout(30s);
    std::optional<Waiting> waiting;
    if (under.empty())
        waiting.emplace("a fresh " + failure.drone + " to take the input");
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
    for (const auto& difference : result.unfit)
        if (!session.json)
            complain("rerun", printable(difference));
    const bool passed = result.outcome == hive::Rerun::Outcome::passed;
    if (session.json)
        write_out(failure_row(failure)
                      .add("outcome", hive::token(result.outcome))
                      .add("rerun_code", result.code)
                      .add("rerun_text", result.text)
                      .add("emitted", result.emitted)
                      .add("unfit", result.unfit)
                      .add("log", result.log)
                      .json()
                  + "\n");
    else
        write_out(printable(sentence(failure, result, hive::duration_text(limit.count() * 1000))) + "\n");
    if (!session.json && !passed && !result.log.empty())
        write_error(result.log);
    return passed ? exit_code::done : exit_code::found;
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.name,
                "a drone that failed, running or not; or a file of --save: NAME.failure, or a path with a slash")
        .required();
    line.option("words", options.words,
                "NO: number of the failure in hivectl exceptions (default: the newest); key=value: parameters of the "
                "new drone, in addition to those of NAME");
    const auto kind =
        line.option("--kind", options.kind, "KIND of the new drone, or a Python file, FILE.py (default: that of NAME)")
            .type_name("KIND");
    const auto program =
        line.option("--program", options.program, "run this program instead, such as another build").type_name("PATH");
    const auto under =
        line.option(
                "--under", options.under,
                "run the drone under this command at this terminal, such as \"gdb --args\" or \"valgrind\", without "
                "--timeout; it gets the input once it is ready")
            .type_name("WORDS");
    line.option("--on", options.on,
                "the failure is kept on this machine, as ssh names it (default: this one, or the one on which "
                "NAME was started with --on)")
        .type_name("HOST");
    line.option("--save", options.save,
                "run nothing; write the failure to this file, which is enough to rerun it anywhere (-: stdout)")
        .type_name("FILE")
        .excludes(kind)
        .excludes(program)
        .excludes(under);
}

}  // namespace

Verb verb()
{
    return {.name = "rerun",
            .group = "errors",
            .usage = "(NAME [NO] | FILE) [key=value ...] [--program PATH] [--under \"gdb --args\"] [options]",
            .summary = "Reruns the input that a drone failed at in a new drone",
            .details =
                "The new drone has the program and the parameters that NAME has, or had before it crashed. It runs "
                "outside of the swarm, in its own directory, without connections, and exits with hivectl. It gets the "
                "kept events at the inputs where NAME had them; after a crash, all that the senders kept. hivectl "
                "reports the outcome and, if the drone failed again, prints the end of its log.\n\n"
                "A failure that another machine keeps is fetched over ssh; each machine has its own numbers. A FILE "
                "that --save or hivectl exceptions --save has written needs neither that drone nor that machine: it "
                "names the kind, the version and the parameters. Since anyone may have made it, parameters that affect "
                "the machine (paths, URLs) are not taken from it, nor is a Python file (--kind FILE.py); hivectl "
                "prints what was left out.\n\n"
                "The exit code is 0 if the drone did not fail, and 9 if it threw, crashed or did not finish in time.",
            .examples = "hivectl rerun face\n"
                        "hivectl rerun face 3 --under \"gdb --args\"\n"
                        "hivectl rerun face --on gpu1 --save face.failure\n"
                        "hivectl rerun face.failure\n"
                        "hivectl rerun face 3 --program build/debug/bin/hive-face scale=1.2",
            .timeout = "how long the drone may take to become ready, and then to finish (default 30)",
            .operands = {Operand::failed_drone, Operand::other},
            .declare = with(declare, run)};
}

}  // namespace hivectl::rerun_verb
