// hivectl replace: a new process in the place of a drone that runs.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../output.hpp"
#include "../places.hpp"
#include "../remote_verb.hpp"
#include "../session.hpp"
#include "../settings.hpp"
#include "../status_line.hpp"
#include "../table.hpp"
#include "../verbs.hpp"

#include <hive/remote.hpp>
#include <hive/replace.hpp>

namespace hivectl::replace_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::string name, kind, log_level;
    std::vector<std::string> settings;
    bool lose_state = false, remote_operator = false;
};

/// For the hivectl there.
std::vector<std::string> words_for(const std::string& drone, const Options& options, std::chrono::milliseconds limit)
{
    std::vector<std::string> words{"replace", drone, "--timeout",
                                   std::to_string(std::max<std::int64_t>(1, limit / 1s))};
    if (!options.kind.empty())
        words.insert(words.end(), {"--kind", options.kind});
    if (!options.log_level.empty())
        words.insert(words.end(), {"--log-level", options.log_level});
    for (const auto& [flag, chosen] :
         {std::pair{"--lose-state", options.lose_state}, {"--remote-operator", options.remote_operator}})
        if (chosen)
            words.emplace_back(flag);
    words.insert(words.end(), options.settings.begin(), options.settings.end());
    return words;
}

int replace_there(const hive::Place& place, const Options& options, Session& session)
{
    if (place.ssh.empty())
        throw hive::Error(hive::Errc::refused,
                          place.drone + " at " + place_text(place)
                              + " was not started through ssh, so it is replaced there",
                          "do it there: hivectl replace " + place.drone);
    const hive::Remote remote(place.ssh, session.home());
    const auto limit = session.timeout(10s);
    auto words = words_for(place.drone, options, limit);
    if (session.json)
        words.emplace_back("--json");
    const Waiting waiting("the new " + place.drone + " to be ready on " + remote.host());
    const auto result = remote.hivectl(words, limit + 60s);  // the old one may be inside a long callback
    write_out(result.out);
    repeat_complaints("replace", remote.host(), result.err);
    return result.exit_code;
}

hive::ReplaceOptions for_library(const Options& options, Session& session)
{
    hive::ReplaceOptions wanted{
        .kind = options.kind,
        .parameters = parse_settings(options.settings),
        .ready_within = session.timeout(10s),
        .lose_state = options.lose_state,
        .home = session.home(),
        .last_words = [](const std::string& line) { complain("replace", "its log says: " + printable(line)); }};
    if (!options.log_level.empty())
        wanted.arguments = {"--log-level", options.log_level};
    if (options.remote_operator)
        wanted.arguments.emplace_back("--remote-operator");
    return wanted;
}

int run(const Options& options, Session& session)
{
    const auto wanted = for_library(options, session);
    auto& application = session.application();
    if (const auto place = application.place(options.name); is_elsewhere(place))
        return replace_there(place, options, session);
    const Waiting waiting("the new " + options.name + " to be ready");
    const auto done = hive::replace(application, options.name, wanted);
    const Row row{{"drone", done.drone},
                  {"kind", done.kind},
                  {"pid", done.pid},
                  {"before", done.before},
                  {"log", done.log.string()}};
    write_out(session.json ? row.json() + "\n" : done.drone + "\n");
    return exit_code::done;
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->name, "the drone that is replaced").required();
    line.option("key=value", options->settings, "parameters for the new one, beside those that the old one was given");
    line.option("--kind", options->kind,
                "what the new one is: a KIND, or a file of Python, FILE.py (default: what the old one is)")
        .type_name("KIND");
    line.flag("--lose-state", options->lose_state,
              "also a drone that remembers earlier events: the new one begins with an empty memory");
    line.flag("--remote-operator", options->remote_operator,
              "who has the swarm's key may also set over the network what concerns this machine");
    line.option("--log-level", options->log_level,
                "lowest level of its log lines: debug, info (default), warning, error or off")
        .type_name("LEVEL")
        .one_of({"debug", "info", "warning", "error", "off"});
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb verb()
{
    return {.name = "replace",
            .group = "run drones",
            .usage = "NAME [--kind KIND|FILE.py] [key=value ...] [options]",
            .summary = "Lets a new process take over from a drone while the swarm runs",
            .details =
                "The new process gets ready beside the old one: its program is loaded, parameters and models too. "
                "Then the old one ends with the event that it works on, and name, place, parameters and connections "
                "pass over. Of a live source a picture or two is skipped; of a source on demand nothing is lost and "
                "nothing comes twice. A drone that has halted stays halted.\n\n"
                "First hivectl looks whether the new program fits: what is connected must be there with types that "
                "fit, and what was set must be there and within its range. As long as the new process is not ready, "
                "the old one notices nothing; if it does not get ready, the last lines of the log say why. From "
                "then on it goes on by itself, even when hivectl is killed.\n\n"
                "What a drone remembers of earlier events cannot be handed over, so a drone that keeps state needs "
                "--lose-state. A source begins again: a file on demand at its beginning. What only one process can "
                "have, such as a V4L2 device, is there for the new one when the old one has ended: a drone of your own "
                "has to try again until then, as the camera does.",
            .examples = "hivectl replace face-1\n"
                        "hivectl replace face-1 --kind detect model=yolov8n.onnx",
            .timeout = "end the new process if it is not ready within this long (default 10)",
            .operands = {Operand::drone, Operand::setting},
            .declare = declare};
}

}  // namespace hivectl::replace_verb
