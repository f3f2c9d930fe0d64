// hivectl results: what drones find, one JSON object a line.
#include "../command_line.hpp"
#include "../event_row.hpp"
#include "../output.hpp"
#include "../printing.hpp"
#include "../session.hpp"
#include "../silence.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

namespace hivectl {
namespace {

struct Options {
    std::vector<std::string> names;
    std::int64_t count = 0;  // 0: without end
    bool ordered = false, notify = false, sync = false;
    int window = 0;  // 0: not said
};

hive::CollectOptions collecting(const Options& options)
{
    hive::CollectOptions result;
    result.ordered = options.ordered;
    result.connection.delivery = options.notify ? hive::Delivery::notification : hive::Delivery::data;
    if (options.sync)
        result.connection.window = 1;
    else if (options.window > 0)
        result.connection.window = options.window;
    return result;
}

void summarize(const hive::CollectCounts& counts)
{
    std::string text;
    for (const auto& [count, what] : {std::pair{counts.missing, "missing"},
                                      {counts.dropped, "dropped here because they were not taken in time"},
                                      {counts.duplicates, "second answers refused"},
                                      {counts.failed, "reported as exceptions instead"}})
        if (count > 0)
            text += ", " + std::to_string(count) + " " + what;
    if (!text.empty())
        complain("results", std::to_string(counts.received) + " received" + text);
}

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    const auto outputs = outputs_named(application, options.names, "application/json");
    const auto collector = application.collect(outputs, collecting(options));
    const int code = print_lines({.verb = "results",
                                  .count = options.count,
                                  .patience = session.patience(),
                                  .reason = [&] { return reason_for_silence(application, outputs); }},
                                 [&](auto patience) -> std::optional<std::string> {
                                     const auto event = collector->next(patience);
                                     return event ? std::optional(event_row(*event).json() + "\n") : std::nullopt;
                                 });
    summarize(collector->counts());
    return code;
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->names,
                "drones, drone.output, or globs; the output goes without saying when only one is JSON")
        .required();
    line.option("-n", options->count, "end after this many")
        .type_name("N")
        .between(std::int64_t{1}, std::int64_t{1} << 53);
    line.flag("--ordered", options->ordered, "in the order of capture, however many drones share the work");
    line.flag("--notify", options->notify, "ask for headers only; the drone need not make the bodies");
    const auto sync = line.flag("--sync", options->sync,
                                "the newest result each time one has been printed; those in between are skipped");
    line.option("--window", options->window, "how many to ask for ahead: what comes beyond is skipped (default 64)")
        .type_name("N")
        .between(1, 64)
        .excludes(sync);
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb results_verb()
{
    return {.name = "results",
            .group = "look",
            .usage = "NAME[.OUTPUT]... [-n N] [options]",
            .summary = "Prints what drones find, one JSON object a line",
            .details = "Each has source, epoch and seq of the capture it belongs to, the sender and output it came "
                       "from, time_us (of the "
                       "capture, microseconds since 1970), age_ms, size (of the body, bytes) and header (what the "
                       "drone found). If "
                       "anything was lost, refused or failed, the last line on stderr says how much.",
            .examples = "hivectl results face -n 5\n"
                        "hivectl results 'face-*' --ordered | jq .header",
            .timeout = "give up when nothing came for this long (default: never)",
            .operands = {Operand::sender},
            .declare = declare};
}

}  // namespace hivectl
