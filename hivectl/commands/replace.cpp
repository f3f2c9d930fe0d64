// hivectl replace: replaces a running drone with a new process.
#include "../verbs.hpp"
#include "run/launch.hpp"
#include "words/settings.hpp"

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

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.order.name, "the drone that is replaced").required();
    line.option("key=value", options.settings, "parameters for the new process, in addition to the old ones");
    line.option("--kind", options.order.kind,
                "the new KIND, or a Python file, FILE.py (default: the same as the old drone)")
        .type_name("KIND");
    line.flag("--lose-state", options.order.lose_state,
              "replace even a stateful drone; the new one starts without its state");
    line.flag("--force", options.order.force,
              "kill a drone that does not answer or is of another version, and start a new one with its parameters and "
              "connections");
    declare_fields(line, options.order);
}

}  // namespace

Verb verb()
{
    return {
        .name = "replace",
        .group = "run drones",
        .usage = "NAME [--kind KIND|FILE.py] [key=value ...] [options]",
        .summary = "Replaces a running drone with a new process",
        .details =
            "The new process starts next to the old one and loads its parameters and models. Then the old one finishes "
            "its current event and exits, and the new one takes over its name, address, parameters and connections. A "
            "live source skips a frame or two; a source on demand loses and repeats nothing. A halted drone stays "
            "halted.\n\n"
            "First hivectl checks that the new program fits: it needs the connected ports, with matching types, and "
            "the parameters that were set, within their ranges. As long as the new process is not ready, the old one "
            "is unaffected, and Ctrl-C stops the new one; if it does not become ready, hivectl prints the end of its "
            "log. After that the replacement completes even if hivectl is killed. The new process has the options of "
            "the old one, except those given here. A drone that was started with --on is replaced on its machine.\n\n"
            "A drone that does not answer, or is of another version of Hive, cannot hand over. With --force, it is "
            "killed after 3 s without an answer, and a new process restores its parameters and connections, as after a "
            "crash.\n\n"
            "State in memory cannot be transferred, so a stateful drone needs --lose-state. A source restarts: a file "
            "on demand starts from the beginning. Exclusive resources, such as a V4L2 device, are free once the old "
            "process has exited: your own drones must retry until then, as the camera does.",
        .examples = "hivectl replace face-1\n"
                    "hivectl replace face-1 --kind detect model=yolov8n.onnx\n"
                    "hivectl replace face-1 --force",
        .timeout = "stop the new process if it is not ready by then (default 10)",
        .operands = {Operand::drone, Operand::setting},
        .declare = with(declare, run)};
}

}  // namespace hivectl::replace_verb
