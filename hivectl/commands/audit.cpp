// hivectl audit: checks whether anything was lost.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "words/format.hpp"

#include <hive/audit.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <ctime>
#include <map>
#include <optional>

namespace hivectl::audit_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    bool watch = false;
    std::string since;
    double interval_s = 1;
};

std::int64_t wall_us()
{
    return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

/// "90s", "10m", "2h" and "1d" are before now; "14:05" and "14:05:10" are the last such time.
std::int64_t since_us(const std::string& text)
{
    static const std::map<char, double> units{{'s', 1}, {'m', 60}, {'h', 3600}, {'d', 86'400}};
    constexpr std::int64_t second_us = 1'000'000;
    double count = 0;
    const auto* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, count);
    if (error == std::errc() && end + 1 == last && units.contains(*end) && count >= 0)
        return wall_us() - static_cast<std::int64_t>(std::min(count, 1e6) * units.at(*end) * second_us);
    const auto now = std::time(nullptr);
    for (const std::string form : {"%H:%M:%S", "%H:%M", "%Y-%m-%dT%H:%M:%S"}) {
        std::tm time{};
        ::localtime_r(&now, &time);
        time.tm_sec = 0;
        const auto* rest = ::strptime(text.c_str(), form.c_str(), &time);
        if (!rest || *rest != '\0')
            continue;
        time.tm_isdst = -1;
        const auto then = std::mktime(&time);
        constexpr std::time_t day = 86'400;
        if (form[1] != 'H' && then > now)
            break;
        return (then > now ? then - day : then) * second_us;
    }
    throw hive::Error(hive::Errc::invalid_argument, "--since " + text + " is not a time",
                      "give 90s, 10m, 2h, 1d, 14:05 or 2026-11-27T14:05:00");
}

/// In reading order.
Row row_of(const hive::AuditRow& row)
{
    const auto json = to_json(row);
    Row result;
    for (const auto* key : {"from", "to", "state", "came"})
        result.add(key, json.at(key));
    for (std::size_t fate = 0; fate < hive::fates; ++fate)
        result.add(std::string(token(static_cast<hive::Fate>(fate))), json.at(token(static_cast<hive::Fate>(fate))));
    for (const auto* key :
         {"in_flight", "received", "processed", "lost", "last_lost_us", "fates", "losses", "differences", "verdict"})
        result.add(key, json.at(key));
    return result;
}

/// "3 min"; empty: nothing was lost.
std::string as_age(const hive::Json& time_us)
{
    return as_duration(
        time_us.is_null() ? time_us : hive::Json(std::max<std::int64_t>(0, wall_us() - time_us.get<std::int64_t>())));
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
                                  {"LAST", "last_lost_us", as_age, nothing},
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
    if (!options.since.empty())
        since_us(options.since);  // a wrong one is refused first
    auto& application = session.application(1s);
    const interrupt::Deferred deferred;
    bool clean = true;
    std::vector<hive::StatusAnswer> last;
    std::chrono::steady_clock::time_point queried;
    do {
        if (std::chrono::steady_clock::now() - queried > 3s)
            last.clear();  // too old to show that a contradiction lasts
        auto audit = hive::audit(application, last);
        queried = std::chrono::steady_clock::now();
        if (!options.since.empty())
            audit.forget_before(since_us(options.since));
        clean = audit.clean();
        report(audit, session, options.watch);
    } while (options.watch
             && interrupt::sleep(std::chrono::milliseconds(static_cast<std::int64_t>(options.interval_s * 1000))));
    return interrupt::requested() && !options.watch ? interrupt::exit_code()
           : clean                                  ? exit_code::done
                                                    : exit_code::found;
}

void declare(CommandLine& line, Options& options)
{
    const auto watch = line.flag("--watch", options.watch, "repeat the table until Ctrl-C");
    line.option("--interval", options.interval_s, "with --watch: time between two tables (default 1)")
        .type_name("SECONDS")
        .seconds(0.05, 3600)
        .needs(watch);
    line.option("--since", options.since,
                "leave out connections whose last loss is older: 90s, 10m, 2h, 1d, 14:05, or 2026-11-27T14:05:00")
        .type_name("TIME");
}

}  // namespace

Verb verb()
{
    return {
        .name = "audit",
        .group = "errors",
        .usage = "[--watch] [--since TIME] [options]",
        .summary = "Reports lost events, and where they were lost",
        .details =
            "One row for each connection, and one for each group, with the counts of both ends. CAME is always the sum "
            "of ACKNOWLEDGED, IN-FLIGHT and the sender's FATES (see hivectl connections). FATES counts the other "
            "events by outcome, at each end. LOST counts those whose delivery was promised: dropped, abandoned, "
            "lost_connection, lost_killed and lost_cut_off at the sender, dropped and abandoned at the receiver. Not "
            "promised are events that were skipped because the receiver had not asked, in flight when the receiver "
            "left, unmatched, or discarded by halt.\n\n"
            "All drones are queried three times, and with --watch twice in each further table. A receiver must have "
            "processed, at the last query, at least what its sender knew of at the query before, and at that query at "
            "most what the sender had sent at the last; so a running swarm causes no false alarm. After a restart, "
            "only events that both ends saw are compared. STATE: both ends; sender only, if the receiver is an "
            "application or does not answer; receiver gone; sender gone; closed: FROM is \"closed connections\", and "
            "the row has what an input lost in connections that no longer exist, or of what hivectl put sent.\n\n"
            "LAST is the age of the last loss, by the clock of the drone that counts it. Counters are those since the "
            "start of a drone and have no history: with --since, a connection whose last loss is older counts as "
            "without loss, and any other with all that it lost.\n\n"
            "The exit code is 9 if anything was lost or the ends disagree, otherwise 0; with --watch, that of the last "
            "table.",
        .examples = "hivectl audit\n"
                    "hivectl audit --since 10m\n"
                    "hivectl audit --json | jq '.[] | select(.lost > 0)'",
        .timeout = "how long to wait for the answer of a drone (default 1)",
        .table = true,
        .operands = {},
        .declare = with(declare, run)};
}

}  // namespace hivectl::audit_verb
