// hivectl top: shows rates, refreshed at an interval.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "words/activity.hpp"
#include "words/rates.hpp"

namespace hivectl::top_verb {
namespace {

using namespace std::chrono_literals;

struct Options {
    bool once = false;
    double interval_s = 1;
};

std::vector<hive::StatusAnswer> look(hive::Application& application)
{
    return application.status(application.drones());
}

std::string shown(const Rates& rates, Form form)
{
    if (form == Form::json)
        return "{\"interval_ms\":" + std::to_string(rates.interval / 1ms) + ",\"drones\":" + json_array(rates.drones)
               + ",\"edges\":" + json_array(rates.edges) + "}\n";
    const std::string drones = table_text(drone_rate_columns(), rates.drones, page_of(form));
    const std::string edges = table_text(edge_rate_columns(), rates.edges, page_of(form));
    return (drones.empty() ? "no drones; start one: hivectl start KIND\n" : drones)
           + (edges.empty() ? "" : "\n" + edges);
}

/// Rows and answers have the same order.
void show_activity(std::vector<Row>& rows, const std::vector<hive::StatusAnswer>& answers)
{
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (const auto* status = value_of(answers[i].status))
            hivectl::show_activity(rows[i], *status);
}

int run(const Options& options, Session& session)
{
    auto& application = session.application(1s);
    const interrupt::Deferred deferred;
    const bool redraw = on_terminal() && !session.json && !options.once;
    auto earlier = look(application);
    auto earlier_at = std::chrono::steady_clock::now();
    for (bool first = true;
         interrupt::sleep(std::chrono::milliseconds(static_cast<std::int64_t>(options.interval_s * 1000)));
         first = false) {
        auto now = look(application);
        const auto now_at = std::chrono::steady_clock::now();
        auto rates = rates_between(earlier, now, now_at - earlier_at);
        if (on_terminal() && !session.json)
            show_activity(rates.drones, now);
        const std::string text = shown(rates, session.form());
        write_out((redraw ? "\x1b[H\x1b[J" : first || session.json ? "" : "\n") + text);
        if (options.once)
            return exit_code::done;
        earlier = std::move(now);
        earlier_at = now_at;
    }
    return interrupt::exit_code();
}

void declare(CommandLine& line, Options& options)
{
    line.flag("--once", options.once, "print one table after one interval");
    line.option("--interval", options.interval_s, "time between samples (default 1)")
        .type_name("SECONDS")
        .seconds(0.05, 3600);
}

}  // namespace

Verb verb()
{
    return {.name = "top",
            .group = "results",
            .usage = "[--once] [--interval SECONDS] [options]",
            .summary = "Shows the rates, ages and losses of drones and connections until Ctrl-C",
            .details = "IN/s and OUT/s are events per second since the last sample (OUT/s: those with a receiver); "
                       "BUSY is the share of that time in the drone's code; CPU is the process's use in percent of one "
                       "processor, MEMORY its memory; AGE is the time from the capture of the newest event to its "
                       "arrival. The busiest drone that receives events is marked slowest: it limits the whole swarm. "
                       "A connection is marked if either end lost events since the last sample; MISSING counts the "
                       "events that are lost for good. The other columns are those of hivectl connections, per second. "
                       "Columns that are 0 in every row are omitted. With --json, one object per sample.",
            .examples = "hivectl top\n"
                        "hivectl top --once --interval 5",
            .timeout = "show a drone as silent if it has not answered by then (default 1)",
            .table = true,
            .operands = {},
            .declare = with(declare, run)};
}

}  // namespace hivectl::top_verb
