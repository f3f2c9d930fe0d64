// Finds the verb, reads its command line, runs it, and turns every failure into a sentence and an exit code.
#include "command_line.hpp"
#include "exit_code.hpp"
#include "help.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "session.hpp"
#include "verbs.hpp"

#include <hive/name.hpp>

#include <csignal>

namespace hivectl {
namespace {

int unknown(const std::vector<Verb>& all, const std::string& word)
{
    std::vector<std::string> names;
    for (const auto& verb : all)
        if (!verb.group.empty())
            names.emplace_back(verb.name);
    const std::string near = hive::nearest(word, names);
    const std::string what = word.starts_with('-') ? "options come after the verb" : "there is no verb " + hive::in_quotes(word);
    complain("", what + (near.empty() || word.starts_with('-') ? "" : "; did you mean " + near + "?") + "; see all: hivectl --help");
    return exit_code::usage;
}

void add_common(CLI::App& app, const Verb& verb, Session& session)
{
    app.add_flag("--json", session.json, "print JSON instead of text; one object a line where it streams");
    app.add_option("--timeout", session.timeout_s, std::string(verb.timeout))->type_name("SECONDS")->check(seconds());
}

int run(const Verb& verb, int argc, char** argv)
{
    CLI::App app{std::string(verb.summary), "hivectl " + std::string(verb.name)};
    app.set_help_flag("-h,--help", "print this");
    Session session;
    const Run action = verb.declare(app, session);
    add_common(app, verb, session);
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        write_out(help_of(verb, app));
        return exit_code::done;
    } catch (const CLI::ParseError& error) {
        complain(verb.name, printable(error.what()) + "; see hivectl " + std::string(verb.name) + " --help");
        return exit_code::usage;
    }
    return action();
}

int dispatch(int argc, char** argv)
{
    const auto all = verbs();
    const std::string word = argc > 1 ? argv[1] : "";
    if (word == "--version") {
        write_out("hivectl " HIVECTL_VERSION "\n");
        return exit_code::done;
    }
    if (word.empty() || word == "--help" || word == "-h" || word == "help") {
        write_out(overview(all));
        return word.empty() ? exit_code::usage : exit_code::done;
    }
    const Verb* verb = verb_named(all, word);
    return verb ? run(*verb, argc - 1, argv + 1) : unknown(all, word);
}

}  // namespace
}  // namespace hivectl

int main(int argc, char** argv)
{
    std::signal(SIGPIPE, SIG_IGN);  // write_out notices; a peer that goes away must not end us
    hivectl::interrupt::install();
    try {
        return hivectl::dispatch(argc, argv);
    } catch (const hive::Error& error) {
        hivectl::complain(argc > 1 ? argv[1] : "", hivectl::explained(error));
        return hivectl::exit_code_of(error.code());
    } catch (const std::exception& error) {
        hivectl::complain(argc > 1 ? argv[1] : "", hivectl::printable(error.what()));
        return hivectl::exit_code::failure;
    }
}
