// hivectl audit: checks whether anything was lost.
#include "../verbs.hpp"
#include "run/command_line.hpp"
#include "run/interrupt.hpp"
#include "run/session.hpp"
#include "words/exit_code.hpp"
#include "words/format.hpp"
#include "words/output.hpp"
#include "words/table.hpp"

#include <hive/audit.hpp>

#include <algorithm>

namespace hivectl::audit_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    bool watch = false;
    double interval_s = 1;
};

/// In reading order.
Row row_of(const hive::AuditRow& row)
{
    const auto json = to_json(row);
    Row result;
    for (const auto* key : {"from", "to", "state", "came"})
        result.add(key, json.at(key));
    for (std::size_t fate = 0; fate < hive::fates; ++fate)
        result.add(std::string(token(static_cast<hive::Fate>(fate))), json.at(token(static_cast<hive::Fate>(fate))));
    for (const auto* key : {"in_flight", "received", "processed", "lost", "fates", "losses", "differences", "verdict"})
        result.add(key, json.at(key));
    return result;
}

Colour verdict_colour(const hive::Json& verdict) { return loss_colour(verdict == "ok" ? 0 : 1); }

const std::vector<Column> columns{{"FROM", "from"},
                                  {"TO", "to"},
                                  {"STATE", "state"},
                                  {"CAME", "came"},
                                  {"ACKNOWLEDGED", "acknowledged"},
                                  {"IN-FLIGHT", "in_flight"},
                                  detail({"RECEIVED", "received"}),
                                  detail({"PROCESSED", "processed"}),
                                  {"LOST", "lost", nullptr, nothing, loss_colour},
                                  {"FATES", "fates", nullptr, nothing},
                                  {"VERDICT", "verdict", nullptr, {}, verdict_colour}};

std::string summary(const hive::Audit& audit)
{
    std::int64_t lost = 0;
    std::size_t different = 0;
    for (const auto& row : audit.rows) {
        lost += row.lost();
        different += row.differences.empty() ? 0 : 1;
    }
    return count_text(static_cast<std::int64_t>(audit.rows.size()), "connection") + ": "
           + (lost == 0 ? "nothing was lost" : count_text(lost, "event") + " lost")
           + (different == 0 ? ", all counts agree" : ", " + std::to_string(different) + " with counts that differ");
}

void report(const hive::Audit& audit, Session& session, bool watch)
{
    std::vector<Row> rows;
    std::ranges::transform(audit.rows, std::back_inserter(rows), row_of);
    if (session.json && watch)
        return write_out(json_array(rows) + "\n");
    print_rows(session.form(), columns, rows);
    if (session.json)
        return;
    for (const auto& row : audit.rows)
        for (const auto& difference : row.differences)
            complain("audit", printable(row.ends.from + " -> " + row.ends.to + ": " + difference));
    for (const auto& drone : audit.silent)
        complain("audit", drone + " does not answer; its connections are known from their other ends only");
    complain("audit", summary(audit));
}

int run(const Options& options, Session& session)
{
    auto& application = session.application(1s);
    const interrupt::Deferred deferred;
    bool clean = true;
    do {
        const auto audit = hive::audit(application);
        clean = audit.clean();
        report(audit, session, options.watch);
    } while (options.watch
             && interrupt::sleep(std::chrono::milliseconds(static_cast<std::int64_t>(options.interval_s * 1000))));
    return interrupt::requested() && !options.watch ? interrupt::exit_code()
           : clean                                  ? exit_code::done
                                                    : exit_code::found;
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    const auto watch = line.flag("--watch", options->watch, "repeat the table until Ctrl-C");
    line.option("--interval", options->interval_s, "with --watch: time between two tables (default 1)")
        .type_name("SECONDS")
        .seconds(0.05, 3600)
        .needs(watch);
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb verb()
{
    return {
        .name = "audit",
        .group = "errors",
        .usage = "[--watch] [options]",
        .summary = "Reports lost events, and where they were lost",
        .details =
            "One row for each connection, and one for each group, with the counts of both ends. CAME is always the sum "
            "of ACKNOWLEDGED, IN-FLIGHT and the sender's FATES (see hivectl connections). FATES counts the other "
            "events by outcome, at each end. LOST counts those whose delivery was promised: dropped, abandoned, "
            "lost_connection, lost_killed and lost_cut_off at the sender, dropped and abandoned at the receiver. Not "
            "promised are events that were skipped because the receiver had not asked, in flight when the receiver "
            "left, unmatched, or discarded by halt.\n\n"
            "All drones are queried three times. A receiver must have processed, at the second query, at least what "
            "its sender knew of at the first and at most what the sender had sent at the third; so a running swarm "
            "causes no false alarm. After a restart, only events that both ends saw are compared. STATE: both ends; "
            "sender only, if the receiver is an application or does not answer; receiver gone; sender gone; "
            "closed: FROM is \"closed connections\", and the row has what an input lost in connections that no longer "
            "exist, or of what hivectl put sent.\n\n"
            "The exit code is 9 if anything was lost or the ends disagree, otherwise 0; with --watch, that of the last "
            "table.",
        .examples = "hivectl audit\n"
                    "hivectl audit --json | jq '.[] | select(.lost > 0)'",
        .timeout = "how long to wait for the answer of a drone (default 1)",
        .table = true,
        .operands = {},
        .declare = declare};
}

}  // namespace hivectl::audit_verb
