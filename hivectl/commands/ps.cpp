// hivectl ps: what runs, and how it is.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../format.hpp"
#include "../session.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

#include <algorithm>
#include <cmath>

namespace hivectl {
namespace {

using namespace std::chrono_literals;

/// "12 without marks, 3 without image": what found no partner, by the input where it was missing.
std::string missing_text(const hive::Json& status)
{
    std::string text;
    for (const auto& matching : list_in(status, "matching"))
        for (const auto& [input, count] : object_in(matching, "missing").items())
            if (count.is_number_integer() && count > 0)
                text += (text.empty() ? "" : ", ") + hive::to_text(count) + " without " + input;
    return text;
}

/// What deserves a look: what its code is busy with, its condition, or its last exception.
std::string note(const hive::Json& status)
{
    std::string text = text_in(status, "condition");
    if (const auto busy_for = count_in(status, "busy_for_us"); busy_for >= 1'000'000)
        text += (text.empty() ? "" : "; ") + duration_text(busy_for) + " in " + text_in(status, "callback");
    if (const auto& exception = object_in(status, "last_exception"); !exception.empty())
        text += (text.empty() ? "" : "; ") + std::string("exception at ") + time_text(count_in(exception, "time_us"))
                + ": " + text_in(exception, "text");
    if (const auto missing = missing_text(status); !missing.empty())
        text += (text.empty() ? "" : "; ") + missing;
    return text;
}

Row silent_row(const hive::Answer& answer)
{
    const bool silent = answer.error->code() == hive::Errc::timeout;
    return Row{
        {"name", answer.drone}, {"kind", nullptr},         {"state", silent ? "silent" : "gone"}, {"pid", nullptr},
        {"uptime_us", nullptr}, {"busy_percent", nullptr}, {"note", answer.error->what()}};
}

Row row_of(const hive::Answer& answer)
{
    const auto& status = answer.result;
    const auto uptime = count_in(status, "uptime_us");
    const auto busy = count_in(status, "busy_us");
    const double percent =
        std::min(100.0, 100.0 * static_cast<double>(busy) / static_cast<double>(std::max<std::int64_t>(1, uptime)));
    Row row{{"name", answer.drone},
            {"kind", text_in(status, "kind")},
            {"state", text_in(status, "state")},
            {"pid", count_in(status, "pid")},
            {"uptime_us", uptime},
            {"busy_percent", std::round(percent * 10) / 10},
            {"note", note(status)},
            {"condition", text_in(status, "condition")}};
    row.add("matching", status.value("matching", hive::Json()));
    return row.add("last_exception", status.value("last_exception", hive::Json()));
}

int run(const std::vector<std::string>& words, Session& session)
{
    auto& application = session.application(1s);
    Outcome outcome("ps");
    const auto names = words.empty() ? application.drones() : drones_named(application, words, outcome);
    std::vector<Row> rows;
    for (const auto& answer : application.status(names)) {
        rows.push_back(answer.error ? silent_row(answer) : row_of(answer));
        outcome.done();
    }
    print_rows(session.json,
               {{"NAME", "name"},
                {"KIND", "kind"},
                {"STATE", "state"},
                {"PID", "pid"},
                {"UPTIME", "uptime_us", as_duration},
                {"BUSY", "busy_percent", as_percent},
                {"NOTE", "note"}},
               rows);
    return outcome.exit_code();
}

Run declare(CommandLine& line, Session& session)
{
    auto names = std::make_shared<std::vector<std::string>>();
    line.option("NAME", *names, "only these drones or globs (default: all)");
    return [names, &session] { return run(*names, session); };
}

}  // namespace

Verb ps_verb()
{
    return {
        .name = "ps",
        .alias = "list",
        .group = "run drones",
        .usage = "[NAME...] [options]",
        .summary = "Lists the drones that run on this machine",
        .details =
            "STATE is starting, idle, busy, halted or stopping, or silent for a drone that runs but does not answer. "
            "BUSY is the share of its life that its code has worked. NOTE is its condition, what it has been "
            "busy with for more than a second, its last exception, and how many events found no partner where "
            "several inputs belong together.",
        .examples = "hivectl ps\n"
                    "hivectl ps --json | jq -r '.[] | select(.state == \"halted\").name'",
        .timeout = "a drone that has not answered by then is shown as silent (default 1)",
        .operands = {Operand::drone},
        .declare = declare};
}

}  // namespace hivectl
