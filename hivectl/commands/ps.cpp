// hivectl ps: lists the running drones and their state.
#include "../verbs.hpp"
#include "run/exception_json.hpp"
#include "words/activity.hpp"
#include "words/format.hpp"
#include "words/places.hpp"
#include "words/targets.hpp"

#include <hive/name.hpp>
#include <hive/stall.hpp>

#include <algorithm>
#include <cmath>

namespace hivectl::ps_verb {
namespace {

using namespace std::chrono_literals;

/// "12 without marks, 3 without image": unmatched events, by the input whose event was missing.
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

/// The NOTE of a drone.
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

/// Why there is no answer, and for another machine the time since the last one.
std::string silence_note(const hive::Place& place, const hive::Error& error)
{
    if (!is_elsewhere(place))
        return error.what();
    return answered_text(place) + "; " + error.what();
}

/// A drone without a status.
Row absent_row(const std::string& drone, const std::string& host, const char* state, const std::string& note)
{
    return Row{{"name", drone},  {"host", host},         {"kind", nullptr},         {"state", state},
               {"pid", nullptr}, {"uptime_us", nullptr}, {"busy_percent", nullptr}, {"note", note}};
}

Row silent_row(const hive::StatusAnswer& answer, const hive::Error& error)
{
    const bool silent = error.code() == hive::Errc::timeout;
    return absent_row(answer.drone, answer.place.host,
                      is_elsewhere(answer.place) ? "unreachable"
                      : silent                   ? "silent"
                                                 : "gone",
                      silence_note(answer.place, error));
}

Row row_of(const hive::StatusAnswer& answer, const hive::Status& status)
{
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
               {"swarm", status.swarm},
               {"matching", matching_json(status)},
               {"last_exception", status.last_exception ? exception_json(*status.last_exception) : hive::Json()}};
}

std::string crash_text(const hive::CrashedDrone& crash)
{
    return crash.signal + (crash.function.empty() ? "" : " in " + crash.function)
           + (crash.source.empty() ? "" : " at " + crash.source.substr(crash.source.rfind('/') + 1));
}

hive::Json crash_json(const hive::CrashedDrone& crash)
{
    return {{"signal", crash.signal},
            {"function", crash.function},
            {"source", crash.source},
            {"pid", crash.pid},
            {"time_us", crash.time_us}};
}

/// "; hivectl rerun face 3" if the input of the crash is kept.
std::string rerun_text(hive::Application& application, const hive::CrashedDrone& crash)
{
    const auto failure = application.failure_of(crash);
    return failure ? "; hivectl rerun " + crash.drone + " " + std::to_string(failure->number) : "";
}

Row crashed_row(hive::Application& application, const hive::CrashedDrone& crash)
{
    return absent_row(crash.drone, hive::Place::here, "crashed",
                      "at " + time_text(crash.time_us) + ": " + crash_text(crash) + rerun_text(application, crash))
        .add("crash", crash_json(crash));
}

/// Without a crash, the last line of the log is the best explanation.
std::string last_cause(const hive::FailedDrone& failed, const hive::CrashedDrone* crash)
{
    if (crash)
        return crash_text(*crash);
    const auto last = failed.log.find_last_not_of('\n');
    const auto begin = last == std::string::npos ? 0 : failed.log.rfind('\n', last) + 1;
    return failed.log.substr(begin, last + 1 - begin);
}

Row failed_row(const hive::FailedDrone& failed, const hive::CrashedDrone* crash)
{
    const auto cause = last_cause(failed, crash);
    return absent_row(failed.drone, hive::Place::here, "failed", failed.reason + (cause.empty() ? "" : ": " + cause))
        .add("log", failed.log)
        .add("crash", crash ? crash_json(*crash) : hive::Json());
}

bool is_meant(const std::string& drone, const std::vector<std::string>& words)
{
    return words.empty()
           || std::ranges::any_of(words, [&](const auto& word) { return hive::matches_glob(word, drone); });
}

void add_crashed(std::vector<Row>& rows, const std::vector<std::string>& words, std::vector<hive::CrashedDrone> crashed,
                 hive::Application& application)
{
    for (const auto& failed : application.failed())
        if (is_meant(failed.drone, words)) {
            const auto crash = std::ranges::find(crashed, failed.drone, &hive::CrashedDrone::drone);
            rows.push_back(failed_row(failed, crash == crashed.end() ? nullptr : &*crash));
            if (crash != crashed.end())
                crashed.erase(crash);
        }
    for (const auto& crash : crashed)
        if (is_meant(crash.drone, words))
            rows.push_back(crashed_row(application, crash));
}

/// Without those that match only crashed drones.
std::vector<std::string> words_that_run(std::vector<std::string> words, const std::vector<hive::CrashedDrone>& crashed,
                                        hive::Application& application)
{
    std::erase_if(words, [&](const std::string& word) {
        return std::ranges::any_of(crashed, [&](const auto& crash) { return is_meant(crash.drone, {word}); })
               && !runs(application, word);
    });
    return words;
}

int run(const std::vector<std::string>& words, Session& session)
{
    const bool person = on_terminal() && !session.json;
    auto& application = session.application(1s);
    Outcome outcome("ps");
    auto crashed = application.crashed();
    const auto names = words.empty() ? application.drones()
                                     : drones_named(application, words_that_run(words, crashed, application), outcome);
    std::vector<Row> rows;
    for (const auto& answer : application.status(names)) {
        const auto* status = value_of(answer.status);
        rows.push_back(status ? row_of(answer, *status) : silent_row(answer, std::get<hive::Error>(answer.status)));
        if (person && status)
            show_activity(rows.back(), *status);
        outcome.done();
    }
    add_crashed(rows, words, std::move(crashed), application);
    if (rows.empty() && words.empty() && !session.json)
        complain("ps", "no drones in " + session.home().string() + "; start one: hivectl start KIND");
    print_rows(session.form(),
               {{"NAME", "name"},
                {"HOST", "host", nullptr, hive::Place::here},
                {"KIND", "kind"},
                {"SWARM", "swarm", nullptr, nothing},
                {"STATE", "state", nullptr, {}, state_colour},
                {"DONE", "done", nullptr, nothing},
                {"PID", "pid"},
                {"UPTIME", "uptime_us", as_duration},
                {"BUSY", "busy_percent", as_percent},
                {"NOTE", "note"}},
               rows);
    return outcome.exit_code();
}

void declare(CommandLine& line, std::vector<std::string>& names)
{
    line.option("NAME", names, "only these drones or globs (default: all)");
}

}  // namespace

Verb verb()
{
    return {.name = "ps",
            .alias = "list",
            .group = "run drones",
            .usage = "[NAME...] [options]",
            .summary = "Lists the drones running on this and other known machines",
            .details =
                "STATE is starting, idle, busy, halted or stopping; on a terminal also sending (a source that emits "
                "events; DONE is its position in its file). silent: it runs but does not answer; unreachable: the same "
                "on another machine; crashed: it died of a signal such as SIGSEGV and was not restarted; failed: it "
                "crashes repeatedly under hivectl up --stay. HOST is its machine, omitted if all run on this one. "
                "SWARM is the swarm that started it. Drones on other machines are those in hivectl place, and those "
                "announced on the local network with this swarm's key. BUSY is the share of its uptime spent in its "
                "code. NOTE has the condition that the drone reports, the stall reason of the drone, an output or an "
                "input, what it has been busy with for over a second, its last exception, and the number of unmatched "
                "events; after a crash the time, the signal, and the function of the drone's own code. The whole stack "
                "is in the log: hivectl logs NAME.",
            .examples = "hivectl ps\n"
                        "hivectl ps --json | jq -r '.[] | select(.state == \"halted\").name'",
            .timeout = "show a drone as silent if it has not answered by then (default 1)",
            .table = true,
            .operands = {Operand::drone},
            .declare = with(declare, run)};
}

}  // namespace hivectl::ps_verb
