// hivectl advise: shows where the time of events goes, and predicts the effect of changes.
#include "../verbs.hpp"
#include "words/format.hpp"
#include "words/status_line.hpp"

#include <hive/advise.hpp>

#include <cmath>

namespace hivectl::advise_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::vector<std::string> drones;
    std::string goal{hive::token(hive::Goal::fps)};
    double time_s = 2;
};

std::string duration(double us) { return duration_text(std::llround(us)); }

std::string stations_table(const std::vector<hive::Station>& stations, const Page& page)
{
    std::vector<Row> rows;
    for (const auto& station : stations)
        rows.push_back(Row{{"what", std::string(hive::token(station.what))},
                           {"at", station.at},
                           {"time_us", std::llround(station.time_us)},
                           {"max_per_s", station.max_per_s > 0 ? hive::Json(station.max_per_s) : hive::Json()}});
    return table_text(
        {{"STEP", "what"}, {"AT", "at"}, {"TIME", "time_us", as_duration}, {"MAX/s", "max_per_s", as_tenths}}, rows,
        page);
}

std::string limit_text(const hive::Station& limit)
{
    return std::string(hive::token(limit.what)) + " at " + printable(limit.at) + ", " + tenths_text(limit.max_per_s)
           + " per second at most";
}

std::string paragraph(const hive::Proposal& proposal)
{
    return printable(proposal.text) + "\n  predicted: " + tenths_text(proposal.predicted_per_s) + " per second"
           + (proposal.predicted_us > 0 ? ", " + duration(proposal.predicted_us) + " old" : "") + " ("
           + std::string(hive::token(proposal.sure)) + " confidence"
           + (proposal.unsure.empty() ? "" : ": " + proposal.unsure) + ")\n"
           + (proposal.next ? "  next limit: " + limit_text(*proposal.next) + "\n" : "")
           + "  try: " + printable(proposal.command) + "\n";
}

std::string shown(const hive::AdvisedLine& line, hive::Goal goal, Form form)
{
    std::string text = printable(line.from) + " to " + printable(line.to) + ": " + tenths_text(line.per_s)
                       + " events per second"
                       + (line.latency_us > 0 ? ", " + duration(line.latency_us) + " old when processed" : "") + "\n\n"
                       + stations_table(line.stations, page_of(form));
    for (std::size_t i = 0; i < std::min<std::size_t>(2, line.limits.size()); ++i)
        text += (i == 0 ? "\nbottleneck: " : "next limit: ") + limit_text(line.limits[i]) + "\n";
    for (const auto& proposal : line.proposals)
        text += "\n" + paragraph(proposal);
    if (line.limits.empty())
        text += line.per_s > 0
                    ? "\nno step is the bottleneck: the model does not explain the rate; measure for longer: --time\n"
                    : "\nno events came while it was measured; see why: hivectl explain "
                          + printable(line.to.substr(0, line.to.find(','))) + "\n";
    else if (line.proposals.empty())
        text += std::string("\nnothing to gain: no known change would make it ")
                + (goal == hive::Goal::fps ? "faster" : "younger") + "\n";
    return text;
}

int run(const Options& options, Session& session)
{
    auto& application = session.application(1s);
    const auto goal = options.goal == hive::token(hive::Goal::fps) ? hive::Goal::fps : hive::Goal::latency;
    const auto advice = hive::advise(
        application, options.drones,
        {.goal = goal, .time = std::chrono::milliseconds(static_cast<std::int64_t>(options.time_s * 1000))});
    if (session.json) {
        write_out(json_text(to_json(advice)) + "\n");
        return exit_code::done;
    }
    if (advice.lines.empty())
        complain("advise", "no drone receives from another one in " + session.home().string()
                               + "; connect two: hivectl connect SENDER RECEIVER");
    for (std::size_t i = 0; i < advice.lines.size(); ++i)
        write_out((i > 0 ? "\n" : "") + shown(advice.lines[i], goal, session.form()));
    return exit_code::done;
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.drones, "the last drone of a pipeline, or its first and last (default: all pipelines)");
    line.option("--goal", options.goal, "what to improve: events per second (fps, default) or their age (latency)")
        .one_of({std::string(hive::token(hive::Goal::fps)), std::string(hive::token(hive::Goal::latency))});
    line.option("--time", options.time_s, "how long to measure (default 2)").type_name("SECONDS").seconds(0.2, 3600);
}

}  // namespace

Verb verb()
{
    return {
        .name = "advise",
        .group = "errors",
        .usage = "[DRONE | FIRST LAST] [--goal fps|latency] [options]",
        .summary = "Measures where events spend their time, and predicts what helps",
        .details =
            "Measures events on their way from a source to the named drone, and prints the mean time of each step: "
            "waiting at the sender until the receiver requests the newest event, encoding, travel, the queue of events "
            "requested ahead, and the work of the drone's code. MAX/s is the rate at the last drone that a step lets "
            "through; the lowest is the bottleneck. Then prints changes that gain at least 5 % (--goal latency: 10 %), "
            "best first, each with a "
            "command, the predicted rate and age, and the confidence. Predictions use only measurements: another drone "
            "is proposed only if processors are free, an encoding only if it was tried (if raw images go to another "
            "machine, some are requested as JPEG).\n\n"
            "--json prints one object: goal, and lines with from, to, per_s, latency_us, stations and limits (what, "
            "at, time_us, max_per_s; what is one of source, waiting, encoding, travel, queue, work, window, "
            "processors), and proposals (what, text, command, predicted_per_s, predicted_us, next, sure, unsure; what "
            "is one of worker, window, encoding, transfer, source_rate, halt, machine; sure is low, medium or high).",
        .examples = "hivectl advise face\n"
                    "hivectl advise camera face --goal latency\n"
                    "hivectl advise --json | jq '.lines[].limits[0]'",
        .timeout = "give up after this long without an answer (default 1)",
        .table = true,
        .operands = {Operand::sender, Operand::receiver},
        .declare = with(declare, run)};
}

}  // namespace hivectl::advise_verb
