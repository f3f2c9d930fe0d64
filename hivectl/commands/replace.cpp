// hivectl replace: replaces a running drone with a new process.
#include "../command_line.hpp"
#include "../launch.hpp"
#include "../session.hpp"
#include "../settings.hpp"
#include "../verbs.hpp"

namespace hivectl::replace_verb {
namespace {

struct Options {
    hive::DroneOrder order;
    std::vector<std::string> settings;
};

int run(const Options& options, Session& session)
{
    auto order = options.order;
    order.set = parse_settings(options.settings);
    return start_in_background(session, start_options(session, "replace", std::move(order)), hive::replace);
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->order.name, "the drone that is replaced").required();
    line.option("key=value", options->settings, "parameters for the new one, beside those that the old one was given");
    line.option("--kind", options->order.kind,
                "what the new one is: a KIND, or a file of Python, FILE.py (default: what the old one is)")
        .type_name("KIND");
    line.flag("--lose-state", options->order.lose_state,
              "also a drone that remembers earlier events: the new one begins with an empty memory");
    declare_fields(line, options->order);
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
                "the old one is unaffected, and Ctrl-C stops the new one; if it does not get ready, the last lines of "
                "the log say why. From then on it goes on by itself, even when hivectl is killed. The new one has the "
                "options of the old one, except those given here. A drone that was started with --on is replaced on "
                "its machine.\n\n"
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
