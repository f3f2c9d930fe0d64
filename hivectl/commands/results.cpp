// hivectl results: prints the results of drones, one JSON object per line.
#include "../verbs.hpp"
#include "run/printing.hpp"
#include "run/result_format.hpp"
#include "run/silence.hpp"
#include "words/losses.hpp"
#include "words/progress.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <algorithm>

namespace hivectl::results_verb {
namespace {

struct Options {
    std::vector<std::string> names;
    std::int64_t count = 0;  // 0: unlimited
    bool ordered = false, notify = false, sync = false, stay = false;
    int window = 0;  // 0: not given
    std::string as = "json", folder, fields;
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

/// " (of camera.image#workers: 17, 21)"
std::string turns_text(const hive::CollectCounts& counts)
{
    std::string text;
    for (const auto& [of, turns] : counts.missing_turns) {
        text += (text.empty() ? " (of " : "; of ") + of + ":";
        for (std::size_t i = 0; i < std::min<std::size_t>(turns.size(), 10); ++i)
            text += (i == 0 ? " " : ", ") + std::to_string(turns[i]);
        text += turns.size() > 10 ? " ..." : "";
    }
    return text.empty() ? "" : text + ")";
}

void summarize(const hive::CollectCounts& counts, const std::vector<Loss>& losses)
{
    std::string text;
    for (const auto& [count, what] : {std::pair{counts.missing, "missing" + turns_text(counts)},
                                      {counts.dropped, std::string("dropped by hivectl, which could not keep up")},
                                      {counts.duplicates, std::string("duplicates refused")},
                                      {counts.failed, std::string("reported as exceptions instead")}})
        if (count > 0)
            text += ", " + std::to_string(count) + " " + what;
    if (!text.empty())
        complain("results", std::to_string(counts.received) + " received" + printable(text));
    for (const auto& loss : losses)
        if (loss.promised)
            complain("results", "lost: " + printable(sentence(loss)));
}

/// Throws Errc::refused if no result could ever arrive.
void look_why(const Options& options, hive::Application& application, const std::vector<hive::Endpoint>& outputs)
{
    const auto explanation = explain_silence(application, outputs);
    const auto text = to_text(explanation);
    if (options.notify && explanation.has(hive::Cause::What::held))
        throw hive::Error(hive::Errc::refused,
                          "the source is on demand, so it waits for a receiver of full events, which --notify is not: "
                              + text,
                          "drop --notify, or connect a receiver");
    if (!text.empty())
        complain("results", "no events: " + text);
}

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    Outcome outcome("results");
    ResultFormat format(options.as, options.folder, options.fields);
    const auto outputs = outputs_named(application, options.names, "application/json", outcome);
    if (outputs.empty())
        return outcome.exit_code();
    const auto collector = application.collect(outputs, collecting(options));
    Progress progress(application, !format.has_images());
    bool lossless = false;
    const auto print = [&] {
        return print_lines({.verb = "results",
                            .count = options.count,
                            .timeout = session.given_timeout(),
                            .reason = [&] { return silence_reason(application, outputs); },
                            .ended = [&] { return options.stay ? std::nullopt : collector->ended(); },
                            .what = names_text(texts_of(outputs)),
                            .silence = [&] { look_why(options, application, outputs); }},
                           [&](auto timeout) -> std::optional<std::string> {
                               const auto event = collector->next(timeout);
                               lossless = lossless || (event && event->identity.lossless);
                               if (event && event->identity.lossless)
                                   progress.note(event->identity);
                               return event ? std::optional(format.text(*event)) : std::nullopt;
                           });
    };
    int code = 0;
    try {
        code = print();
    } catch (...) {
        if (format.has_images())
            format.finish();  // writes what has arrived
        throw;
    }
    format.finish();
    const auto counts = collector->counts();
    const auto lost = losses_now(application, collector->inputs());
    summarize(counts, lost);
    const bool broken = promise_broken(counts, lost, options.ordered, lossless);
    return outcome.exit_code(code == exit_code::done && broken ? exit_code::partly_done : code);
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.names, "drones, drone.output, or globs; omit the output if only one is JSON")
        .required();
    line.option("-n", options.count, "end after this many").count();
    line.option("--as", options.as, "json (default), csv, coco or yolo: boxes for other tools")
        .type_name("FORM")
        .one_of({"json", "csv", "coco", "yolo"});
    line.option("-o,--output", options.folder, "with --as coco or yolo: new folder for the files").type_name("FOLDER");
    line.option("--fields", options.fields, "with --as csv: header fields instead of boxes, one line per result")
        .type_name("FIELD,...");
    line.flag("--ordered", options.ordered, "print results in capture order, even if several drones share the work");
    line.flag("--notify", options.notify, "receive headers only, so that the drone need not make the bodies");
    line.flag("--stay", options.stay, "keep waiting after every source has ended");
    const auto sync =
        line.flag("--sync", options.sync, "after printing a result, get the newest one and skip those in between");
    line.option("--window", options.window, "results to request ahead; further ones are skipped (default 64)")
        .type_name("N")
        .between(1, 64)
        .excludes(sync);
}

}  // namespace

Verb verb()
{
    return {.name = "results",
            .group = "results",
            .usage = "NAME[.OUTPUT]... [-n N] [options]",
            .summary = "Prints the results of drones, one JSON object per line",
            .details =
                "Exits when every source has ended and every result is printed. Each line has source, epoch and seq of "
                "the capture, the sender and output, time_us (of the capture, microseconds since 1970), age_ms, size "
                "(of the body, in bytes) and header (the result). If anything was lost, refused or failed, the last "
                "lines on stderr report how much and where. The exit code is 8 if results are missing with --ordered "
                "or from a source on demand. If a drone failed at an event, there is an exception instead: see hivectl "
                "exceptions. With --as csv, each box is a line, and with --fields each result: a.b is field b of a, or "
                "the object named b in the array a. coco writes dataset.json and results.json, yolo classes.txt and "
                "labels/NAME.txt. Images are named after their file, or after the video or source and the capture "
                "number; their size is width and height in the header. Results without boxes are refused, and for coco "
                "and yolo also those without a size.",
            .examples = "hivectl results face -n 5\n"
                        "hivectl results 'face-*' --ordered | jq .header\n"
                        "hivectl results face -n 5 --as coco -o faces\n"
                        "hivectl results face -n 5 --as csv --fields width,faces.0.x",
            .timeout = "give up after this long without a result (default: never)",
            .operands = {Operand::sender},
            .declare = with(declare, run)};
}

}  // namespace hivectl::results_verb
