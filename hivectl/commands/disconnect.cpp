// hivectl disconnect: removes a connection, or makes a source stop waiting for a receiver that is gone.
#include "../verbs.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

namespace hivectl::disconnect_verb {
namespace {

struct Options {
    std::string sender;
    std::vector<std::string> receivers;
};

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    const auto sender = application.endpoint(options.sender);
    Outcome outcome("disconnect");
    for (const auto& receiver : endpoints_named(application, options.receivers, outcome)) {
        outcome.request(to_text(receiver), [&] {
            const Waiting waiting(to_text(receiver) + " to disconnect");
            application.disconnect(sender, receiver);
            const auto from = to_text(sender), to = to_text(receiver);
            write_out(session.json ? Row{{"from", from}, {"to", to}}.json() + "\n" : from + " -x- " + to + "\n");
        });
    }
    return outcome.exit_code();
}

void declare(CommandLine& line, Options& options)
{
    line.option("SENDER", options.sender, "drone or drone.output").required();
    line.option("RECEIVER", options.receivers, "drones or drone.input, one or several; globs such as 'face-*'")
        .required();
}

}  // namespace

Verb verb()
{
    return {.name = "disconnect",
            .group = "connections",
            .usage = "SENDER[.OUTPUT] RECEIVER[.INPUT]... [options]",
            .summary = "Ends a connection",
            .details = "Without ports, ends every connection between the two drones. If the receiver has exited, its "
                       "sender forgets it, and a source stops waiting for it.",
            .examples = "hivectl disconnect camera face\n"
                        "hivectl disconnect camera 'face-*'",
            .operands = {Operand::sender, Operand::receiver},
            .declare = with(declare, run)};
}

}  // namespace hivectl::disconnect_verb
