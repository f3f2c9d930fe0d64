// hivectl ps: what runs, and how it is.
#include "../command_line.hpp"
#include "../exception_json.hpp"
#include "../exit_code.hpp"
#include "../format.hpp"
#include "../places.hpp"
#include "../session.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

#include <hive/name.hpp>
#include <hive/stall.hpp>

#include <algorithm>
#include <cmath>

namespace hivectl::ps_verb {
namespace {

using namespace std::chrono_literals;

/// "12 without marks, 3 without image": what found no partner, by the input where it was missing.
std::string missing_text(const hive::Status& status)
{
    std::string text;
    for (const auto& matching : status.matching)
        for (const auto& [input, count] : matching.missing)
            if (count > 0)
                text += (text.empty() ? "" : ", ") + std::to_string(count) + " without " + input;
    return text;
}

std::string busy_text(const hive::Status& status)
{
    return status.busy_for_us >= 1'000'000 ? duration_text(status.busy_for_us) + " in " + status.callback : "";
}

std::string exception_text(const hive::Status& status)
{
    const auto& exception = status.last_exception;
    return exception ? "exception at " + time_text(exception->time_us) + ": " + exception->text : "";
}

/// What deserves a look.
std::string note(const hive::Status& status)
{
    std::string text;
    for (const auto& part :
         {status.condition, hive::stall_text(status), busy_text(status), exception_text(status), missing_text(status)})
        text += (text.empty() || part.empty() ? "" : "; ") + part;
    return text;
}

hive::Json matching_json(const hive::Status& status)
{
    hive::Json rows = hive::Json::array();
    for (const auto& matching : status.matching)
        rows.push_back({{"inputs", matching.inputs},
                        {"sets", matching.sets},
                        {"waiting", matching.waiting},
                        {"unmatched", matching.unmatched},
                        {"duplicates", matching.duplicates},
                        {"missing", matching.missing}});
    return rows.empty() ? hive::Json() : rows;
}

/// Why there is no answer, and of one on another machine how long ago there was one.
std::string silence_note(const hive::StatusAnswer& answer)
{
    if (!is_elsewhere(answer.place))
        return answer.error->what();
    return answered_text(answer.place) + "; " + answer.error->what();
}

Row silent_row(const hive::StatusAnswer& answer)
{
    const bool silent = answer.error->code() == hive::Errc::timeout;
    return Row{
        {"name", answer.drone},    {"host", answer.place.host},
        {"kind", nullptr},         {"state", is_elsewhere(answer.place) ? "unreachable" : silent ? "silent" : "gone"},
        {"pid", nullptr},          {"uptime_us", nullptr},
        {"busy_percent", nullptr}, {"note", silence_note(answer)}};
}

Row row_of(const hive::StatusAnswer& answer)
{
    const auto& status = answer.status;
    const double percent = std::min(100.0, 100.0 * static_cast<double>(status.busy_us)
                                               / static_cast<double>(std::max<std::int64_t>(1, status.uptime_us)));
    return Row{{"name", answer.drone},
               {"host", answer.place.host},
               {"kind", status.kind},
               {"state", token(status.state)},
               {"pid", status.pid},
               {"uptime_us", status.uptime_us},
               {"busy_percent", std::round(percent * 10) / 10},
               {"note", note(status)},
               {"condition", status.condition},
               {"why", token(status.why)},
               {"matching", matching_json(status)},
               {"last_exception", status.last_exception ? exception_json(*status.last_exception) : hive::Json()}};
}

/// The last line of its log says most about why.
Row failed_row(const hive::FailedDrone& failed)
{
    const auto last = failed.log.find_last_not_of('\n');
    const auto begin = last == std::string::npos ? 0 : failed.log.rfind('\n', last) + 1;
    const auto line = failed.log.substr(begin, last + 1 - begin);
    return Row{{"name", failed.drone},    {"host", hive::Place::here},
               {"kind", nullptr},         {"state", "failed"},
               {"pid", nullptr},          {"uptime_us", nullptr},
               {"busy_percent", nullptr}, {"note", failed.reason + (line.empty() ? "" : ": " + line)},
               {"log", failed.log}};
}

void add_failed(std::vector<Row>& rows, const std::vector<std::string>& words, hive::Application& application)
{
    for (const auto& failed : application.failed())
        if (words.empty()
            || std::ranges::any_of(words, [&](const auto& word) { return hive::matches_glob(word, failed.drone); }))
            rows.push_back(failed_row(failed));
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
    add_failed(rows, words, application);
    print_rows(session.json,
               {{"NAME", "name"},
                {"HOST", "host", nullptr, hive::Place::here},
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

Verb verb()
{
    return {
        .name = "ps",
        .alias = "list",
        .group = "run drones",
        .usage = "[NAME...] [options]",
        .summary = "Lists the drones that run, on this machine and on those that it knows of",
        .details =
            "STATE is starting, idle, busy, halted or stopping, or silent for a drone that runs but does not answer, "
            "or unreachable for one on another machine that does not, or failed for one that fell too often under "
            "hivectl up --stay. HOST is where it runs; the column is left out when "
            "all run on this machine. Drones of other machines are those of the list of places (hivectl place), and "
            "those that announce themselves on the local network and have this swarm's key. "
            "BUSY is the share of its lifetime that its code was working. NOTE says what the drone reports about its "
            "world, why it or one of its outputs or inputs stands still, what has kept it busy for more than a second, "
            "its last exception, and how many events found no partner where several inputs belong together.",
        .examples = "hivectl ps\n"
                    "hivectl ps --json | jq -r '.[] | select(.state == \"halted\").name'",
        .timeout = "a drone that has not answered by then is shown as silent (default 1)",
        .operands = {Operand::drone},
        .declare = declare};
}

}  // namespace hivectl::ps_verb
