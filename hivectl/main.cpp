// Finds the verb, reads its command line, runs it, and turns every failure into a sentence and an exit code.
#include "run/help.hpp"
#include "run/interrupt.hpp"
#include "verbs.hpp"

#include <hive/name.hpp>
#include <hive/version.hpp>

#include <algorithm>
#include <csignal>
#include <fcntl.h>
#include <unistd.h>

namespace hivectl {
namespace {

int unknown(const std::vector<Verb>& all, const std::string& word)
{
    std::vector<std::string> names;
    for (const auto& verb : all)
        if (!verb.group.empty())
            names.emplace_back(verb.name);
    if (word.starts_with('-')) {
        complain_about("", {hive::Errc::invalid_argument, "options come after the verb", "see all: hivectl --help"});
        return exit_code::usage;
    }
    complain_about("",
                   hive::no_such("there is no verb " + hive::in_quotes(word), word, names, "see all: hivectl --help"));
    return exit_code::usage;
}

int run(const Verb& verb, int argc, char** argv)
{
    CommandLine line;
    Session session;
    const Run action = declared(verb, line, session);
    try {
        if (!line.read(argc, argv)) {
            write_out(help_of(verb, line));
            return exit_code::done;
        }
    } catch (const UsageError& error) {
        complain_about(verb.name, {hive::Errc::invalid_argument, error.what(),
                                   "see hivectl " + std::string(verb.name) + " --help"});
        return exit_code::usage;
    }
    return action();
}

int dispatch(int argc, char** argv)
{
    const auto all = verbs();
    if (std::any_of(argv, argv + argc, [](const char* text) { return std::string_view(text) == "--json"; }))
        print_failures_as_json();  // also usage errors
    const std::string word = argc > 1 ? argv[1] : "";
    if (word == "--version") {
        write_out("hivectl " HIVECTL_VERSION " (protocol " + std::to_string(hive::protocol_version()) + ")\n");
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

/// A standard descriptor that is closed at the start would become the number of a socket or file, which would then get
/// our output. Opens it in the wrong mode, so that using it fails.
static void take_standard_descriptors()
{
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(descriptor, F_GETFD) < 0)
            static_cast<void>(::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

int main(int argc, char** argv)
{
    take_standard_descriptors();
    std::signal(SIGCHLD, SIG_DFL);  // if ignored, every child would seem to succeed
    std::signal(SIGPIPE, SIG_IGN);  // write_out handles it; a closing peer must not kill us
    hivectl::interrupt::install();
    try {
        return hivectl::dispatch(argc, argv);
    } catch (const hive::Error& error) {
        hivectl::complain_about(argc > 1 ? argv[1] : "", error);
        if (error.code() == hive::Errc::stopped && hivectl::interrupt::requested())
            return hivectl::interrupt::exit_code();
        return hivectl::exit_code_of(error.code());
    } catch (const std::exception& error) {
        hivectl::complain(argc > 1 ? argv[1] : "", hivectl::printable(error.what()));
        return hivectl::exit_code::failure;
    }
}
