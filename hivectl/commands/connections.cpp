// hivectl connections: lists the connections, with the counters of both ends.
#include "words/connections.hpp"
#include "../verbs.hpp"
#include "words/format.hpp"
#include "words/places.hpp"
#include "words/targets.hpp"

#include <hive/name.hpp>

#include <algorithm>

namespace hivectl::connections_verb {
namespace {

using namespace std::chrono_literals;

bool concerns(const Row& row, const std::vector<std::string>& drones)
{
    return std::ranges::any_of(drones, [&](const std::string& drone) {
        return hive::belongs_to(row.text("from"), drone) || hive::belongs_to(row.text("to"), drone);
    });
}

const std::vector<Column> columns{{"FROM", "from"},
                                  {"FROM-HOST", "from_host", nullptr, hive::Place::here},
                                  {"TO", "to"},
                                  {"TO-HOST", "to_host", nullptr, hive::Place::here},
                                  {"KIND", "kind", nullptr, "receiver"},
                                  {"GROUP", "group", nullptr, nothing},
                                  detail({"TRANSFER", "transfer"}),
                                  detail({"DELIVERY", "delivery", nullptr, "data"}),
                                  detail({"WINDOW", "window"}),
                                  detail({"ROUND-TRIP", "round_trip_us", as_duration, nothing}),
                                  detail({"ENCODING", "encoding", nullptr, nothing}),
                                  detail({"BY", "way", nullptr, nothing}),
                                  {"STATE", "state", nullptr, {}, state_colour},
                                  detail({"KNOWN-BY", "known_by", nullptr, "both"}),
                                  {"CAME", "came"},
                                  detail({"ACKNOWLEDGED", "acknowledged"}),
                                  detail({"SKIPPED", "skipped", nullptr, nothing}),
                                  detail({"DROPPED", "dropped", nullptr, nothing, loss_colour}),
                                  detail({"PASSED-ON", "passed_on", nullptr, nothing}),
                                  detail({"ABANDONED", "abandoned", nullptr, nothing, loss_colour}),
                                  detail({"LOST-CONNECTION", "lost_connection", nullptr, nothing, loss_colour}),
                                  detail({"LOST-KILLED", "lost_killed", nullptr, nothing, loss_colour}),
                                  detail({"LOST-CUT-OFF", "lost_cut_off", nullptr, nothing, loss_colour}),
                                  detail({"LOST-LEFT", "lost_left", nullptr, nothing, loss_colour}),
                                  detail({"IN-FLIGHT", "in_flight"}),
                                  detail({"R-DROPPED", "dropped_by_receiver", nullptr, nothing, loss_colour}),
                                  detail({"R-ABANDONED", "abandoned_by_receiver", nullptr, nothing, loss_colour}),
                                  detail({"DUPLICATES", "duplicates", nullptr, nothing}),
                                  detail({"DISCARDED", "discarded", nullptr, nothing}),
                                  detail({"UNMATCHED", "unmatched", nullptr, nothing}),
                                  {"MISSING", "missing", nullptr, nothing, loss_colour},
                                  {"WHY", "why", nullptr, nothing}};

/// Over a long round trip, a receiver that requests one event at a time mostly waits.
void advise_windows(const std::vector<Row>& rows)
{
    for (const auto& row : rows)
        if (!row["window_advised"].is_null())
            complain("connections",
                     row.text("from") + " -> " + row.text("to") + ": with a round trip of "
                         + duration_text(static_cast<std::int64_t>(row.number("round_trip_us"))) + " a window of "
                         + std::to_string(static_cast<std::int64_t>(row.number("window"))) + " lets at most "
                         + std::to_string(
                             static_cast<std::int64_t>(1e6 * row.number("window") / row.number("round_trip_us")))
                         + " events per second through; try: hivectl connect " + row.text("from") + " " + row.text("to")
                         + " --window " + std::to_string(static_cast<std::int64_t>(row.number("window_advised"))));
}

int run(const std::vector<std::string>& words, Session& session)
{
    auto& application = session.application(1s);
    Outcome outcome("connections");
    const auto named = drones_named(application, words, outcome);
    if (!words.empty() && named.empty())
        return outcome.exit_code();
    const auto statuses = application.status(application.drones());
    for (const auto& answer : statuses)
        if (error_of(answer.status))
            complain("connections", answer.drone + (is_elsewhere(answer.place) ? " at " + answer.place.host : "")
                                        + " does not answer; its connections are known from their other ends only");
    auto rows = connection_rows(statuses);
    if (!words.empty())
        std::erase_if(rows, [&](const Row& row) { return !concerns(row, named); });
    outcome.done();
    if (!session.json)
        advise_windows(rows);
    print_rows(session.form(), columns, rows);
    return outcome.exit_code();
}

void declare(CommandLine& line, std::vector<std::string>& names)
{
    line.option("NAME", names, "only connections of these drones or globs (default: all)");
}

}  // namespace

Verb verb()
{
    return {.name = "connections",
            .alias = "edges",
            .group = "connections",
            .usage = "[NAME...] [options]",
            .summary = "Lists connections, with the counters of both ends",
            .details =
                "One row for each connection, and one for each group that shares work. Columns that are 0 or empty in "
                "every row are omitted; --json has all of them.\n\n"
                "The sender counts: came = acknowledged + skipped + dropped + passed_on + abandoned + lost_connection "
                "+ lost_killed + lost_cut_off + lost_left + in_flight. skipped: replaced by a newer event before the "
                "receiver asked. dropped: the queue of a stream was full. passed_on: reassigned to another group "
                "member. abandoned: given up after failed attempts. lost: in flight when the connection broke, or when "
                "the receiver died, was cut off or left.\n\n"
                "The receiver counts: received = processed + abandoned_by_receiver (its code threw) + duplicates "
                "(rejected) + discarded (not started when it halted or left) + dropped_by_receiver (its queue was "
                "full) + unmatched (no matching event at the other inputs) + queued + in_hand; in the table R- stands "
                "for receiver. missing: events that the receiver will never process.\n\n"
                "FROM-HOST and TO-HOST: where the two ends run, as in `hivectl ps`; each is omitted if all of its ends "
                "run on this machine, and null (-) if hivectl does not know that end as a drone. ROUND-TRIP: for a "
                "receiver on another machine, the shortest recent round trip; a receiver requests WINDOW events ahead, "
                "so window / round trip limits the events per second; stderr says when a larger window would help. "
                "STATE: connected; waiting: the receiver is not registered; place_kept: it was cut off, and the sender "
                "keeps its events; gone. KNOWN-BY sender: the receiver is an application, or has not reported it; "
                "receiver: the sender does not run. WHY: the stall reason. ENCODING and BY: encoding and transport of "
                "the bodies (shared memory or socket).\n\n"
                "More keys of --json: kind (receiver, member, group), delivery, way, shared and fallback (bodies in "
                "shared memory, and bodies that did not fit there), waiting (the part of in_flight that is not sent "
                "yet), age_us, clock_offset_us (the sender's clock minus the receiver's, between two machines; ages "
                "are corrected by it), window_advised, error.",
            .examples = "hivectl connections\n"
                        "hivectl connections camera --json | jq -r '.[].to'",
            .timeout = "how long to wait for drones that do not answer (default 1)",
            .table = true,
            .operands = {Operand::drone},
            .declare = with(declare, run)};
}

}  // namespace hivectl::connections_verb
