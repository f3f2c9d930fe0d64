// hivectl edges: the connections that exist, as both ends see them.
#include "../command_line.hpp"
#include "../connections.hpp"
#include "../exit_code.hpp"
#include "../output.hpp"
#include "../session.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

#include <algorithm>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

bool concerns(const Row& row, const std::vector<std::string>& drones)
{
    return std::ranges::any_of(drones, [&](const std::string& drone) {
        return row.text("from").starts_with(drone + ".") || row.text("to") == drone
               || row.text("to").starts_with(drone + ".");
    });
}

int run(const std::vector<std::string>& words, Session& session)
{
    auto& application = session.application(1s);
    const auto statuses = application.status(application.drones());
    for (const auto& answer : statuses)
        if (answer.error)
            complain("edges", answer.drone + " does not answer; its connections are known from their other ends only");
    auto rows = connection_rows(statuses);
    if (!words.empty())
        std::erase_if(rows,
                      [drones = drones_named(application, words)](const Row& row) { return !concerns(row, drones); });
    print_rows(session.json,
               {{"FROM", "from"},
                {"TO", "to"},
                {"TRANSFER", "transfer"},
                {"WINDOW", "window"},
                {"GROUP", "group"},
                {"ENCODING", "encoding"},
                {"BY", "way"},
                {"STATE", "state"},
                {"KNOWN-BY", "known_by"},
                {"PRODUCED", "produced"},
                {"DELIVERED", "delivered"},
                {"SKIPPED", "skipped"},
                {"DROPPED", "dropped"},
                {"ABANDONED", "abandoned"},
                {"IN-FLIGHT", "in_flight"}},
               rows);
    return exit_code::done;
}

Run declare(CommandLine& line, Session& session)
{
    auto names = std::make_shared<std::vector<std::string>>();
    line.option("NAME", *names, "only connections of these drones or globs (default: all)");
    return [names, &session] { return run(*names, session); };
}

}  // namespace

Verb edges_verb()
{
    return {
        .name = "edges",
        .group = "wire them",
        .usage = "[NAME...] [options]",
        .summary = "Lists the connections, as both ends know them",
        .details =
            "For each, produced = delivered + skipped + dropped + abandoned + in flight, counted at the sender. "
            "skipped: "
            "the receiver was not ready; dropped: the queue of a stream was full; abandoned: given up after failures. "
            "ENCODING and BY are how the bodies travel: by shared memory within a machine, unless they are small; 'N "
            "by socket': there was no room. KNOWN-BY sender: the receiver is an application, or does not know of it; "
            "receiver: the sender does not (yet, or no longer) run.",
        .examples = "hivectl edges\n"
                    "hivectl edges camera --json | jq -r '.[].to'",
        .timeout = "how long to wait for drones that do not answer (default 1)",
        .operands = {Operand::drone},
        .declare = declare};
}

}  // namespace hivectl
