// hivectl logs: prints a drone's log, wherever it runs.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "run/remote_verb.hpp"
#include "words/places.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <hive/name.hpp>
#include <hive/remote.hpp>
#include <hive/swarm.hpp>

#include <algorithm>
#include <deque>
#include <fstream>
#include <optional>
#include <sstream>

namespace hivectl::logs_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string name;
    int lines = 100;
    bool follow = false;
};

void print_line(const std::string& name, const std::string& line, bool json)
{
    write_out(json ? Row{{"drone", name}, {"line", line}}.json() + "\n" : printable(line) + "\n");
}

/// The last lines, and the offset up to which the file was read. With --follow an incomplete last line waits for its
/// end; otherwise it is printed, as the last output of a killed program.
std::streamoff print_last(const std::filesystem::path& file, const Options& options, bool json)
{
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw hive::Error(hive::Errc::not_found, "there is no log of " + options.name + " here",
                          "see what runs: hivectl ps");
    std::deque<std::string> last;
    std::streamoff read = 0;
    for (std::string line; std::getline(in, line) && !(in.eof() && options.follow);) {
        read = in.eof() ? read : std::streamoff(in.tellg());
        last.push_back(line);
        if (last.size() > static_cast<std::size_t>(options.lines))
            last.pop_front();
    }
    for (const auto& line : last)
        print_line(options.name, line, json);
    return read;
}

/// Complete lines after `from`; a shorter file was rotated.
std::streamoff print_new(const std::filesystem::path& file, std::streamoff from, const Options& options, bool json)
{
    std::error_code missing;
    const auto size = std::filesystem::file_size(file, missing);
    if (missing)
        return 0;
    std::ifstream in(file, std::ios::binary);
    in.seekg(from <= static_cast<std::streamoff>(size) ? from : 0);
    auto read = in.tellg();
    for (std::string line; std::getline(in, line) && !in.eof(); read = in.tellg())
        print_line(options.name, line, json);
    return read;
}

int follow(const std::filesystem::path& file, std::streamoff from, const Options& options, Session& session)
{
    const interrupt::Deferred deferred;
    const auto timeout = session.given_timeout();
    const auto end =
        timeout ? std::chrono::steady_clock::now() + *timeout : std::chrono::steady_clock::time_point::max();
    while (interrupt::sleep(100ms)) {
        from = print_new(file, from, options, session.json);
        if (std::chrono::steady_clock::now() >= end)
            return exit_code::timed_out;
    }
    return interrupt::exit_code();
}

/// The output of a Slurm step arrives on the machine that started it.
bool is_step(hive::Application& application, const std::string& drone)
{
    const auto ignore = [](const hive::Error&) {};
    return std::ranges::any_of(hive::Swarm::remembered(application, ignore), [&](const hive::SwarmPlan& plan) {
        const auto* const found = plan.drone(drone);
        return found && plan.engine_of(found->host).name == "slurm";
    });
}

int read_there(const hive::Place& place, const Options& options, Session& session)
{
    if (place.ssh.empty())
        throw hive::Error(hive::Errc::refused,
                          place.drone + " at " + place_text(place) + " was not started over ssh; its log is there",
                          "ask there: hivectl logs " + place.drone);
    std::vector<std::string> words{"logs", place.drone, "-n", std::to_string(options.lines)};
    if (session.json)
        words.emplace_back("--json");
    if (options.follow) {
        words.emplace_back("--follow");
        return hive::Remote(place.ssh, session.home()).hivectl_attached(words);
    }
    const auto result = run_there(session, place, words, "the log of " + place.drone);
    write_out(result.out);
    return result.exit_code;
}

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    if (runs(application, options.name))
        if (const auto place = application.place(options.name);
            is_elsewhere(place) && !is_step(application, place.drone))
            return read_there(place, options, session);
    const auto name = options.name.substr(0, options.name.find('@'));
    const auto file = session.home() / (hive::require_name(name, "drone") + ".log");
    const auto read = print_last(file, options, session.json);
    return options.follow ? follow(file, read, options, session) : exit_code::done;
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.name, "a drone, running or crashed").required();
    line.option("-n", options.lines, "number of lines from the end (default 100)").type_name("N").between(1, 1'000'000);
    line.flag("-f,--follow", options.follow, "keep printing new lines until Ctrl-C");
}

}  // namespace

Verb verb()
{
    return {.name = "logs",
            .group = "run drones",
            .usage = "NAME [-n LINES] [--follow] [options]",
            .summary = "Prints the end of a drone's log, wherever it runs",
            .details = "On this machine it reads NAME.log in the runtime directory, created by hivectl start. After a "
                       "crash (a signal such as SIGSEGV) it ends with the stack. The log of a drone that was started "
                       "with --on is read over ssh; that of a Slurm step is on this machine.",
            .examples = "hivectl logs face -n 5",
            .timeout = "how long to wait for the other machine (default 5), or to follow (default: forever)",
            .operands = {Operand::drone},
            .declare = with(declare, run)};
}

}  // namespace hivectl::logs_verb
