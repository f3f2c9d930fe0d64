// hivectl record: records outputs into a file, and reports missing events.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "run/printing.hpp"
#include "run/silence.hpp"
#include "words/format.hpp"
#include "words/losses.hpp"
#include "words/progress.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <hive/recording/event_record.hpp>

#include <csignal>

namespace hivectl::record_verb {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Options {
    std::vector<std::string> names;
    std::string file, encoding;
    std::int64_t count = 0;  // 0: unlimited
    std::optional<double> seconds;
    double max_size = 0;
    int window = 64;
    bool notify = false, stream = false, overwrite = false, stay = false;
};

/// A drone without a port stands for all of its outputs.
std::vector<std::string> words_of(hive::Application& application, const std::string& name)
{
    std::vector<std::string> words;
    for (const auto& end : endpoints_named(application, {name})) {
        if (!end.port.empty())
            words.push_back(to_text(end));
        else
            for (const auto& port : application.describe(end.drone).outputs)
                words.push_back(end.drone + "." + port.name);
    }
    if (words.empty())
        throw hive::Error(hive::Errc::not_found, name + " has no outputs to record",
                          "see its ports: hivectl describe " + name);
    return words;
}

std::vector<hive::Endpoint> outputs_of(hive::Application& application, const std::vector<std::string>& names,
                                       Outcome& outcome)
{
    std::vector<std::string> words;
    for (const auto& name : names)
        outcome.attempt(name, [&] { add_new(words, words_of(application, name)); });
    return outputs_named(application, words, "", outcome);
}

hive::CollectOptions collecting(const Options& options)
{
    hive::CollectOptions result;
    result.connection.transfer = options.stream ? hive::Transfer::streaming : hive::Transfer::synchronized;
    result.connection.delivery = options.notify ? hive::Delivery::notification : hive::Delivery::data;
    result.connection.window = options.window;
    result.connection.encoding = options.encoding;
    return result;
}

/// The writer has how the recording ended; the exit code covers other failures.
int take_events(hive::Collector& collector, hive::recording::Writer& writer, Progress& progress, Waiting& waiting,
                const Options& options, std::optional<std::chrono::milliseconds> timeout,
                const std::function<std::string()>& reason)
{
    const auto limit = options.seconds
                           ? Clock::now() + std::chrono::microseconds(static_cast<std::int64_t>(*options.seconds * 1e6))
                           : Clock::time_point::max();
    auto last = Clock::now();
    while (writer.ended().empty() && !interrupt::requested()) {
        if (Clock::now() >= limit) {
            writer.finish("time over");
        } else if (const auto event = collector.next(100ms)) {
            progress.note(event->identity);
            if (event->received < limit)
                hive::recording::append(writer, *event);
            if (writer.summary().events() == options.count)
                writer.finish("count reached");
            last = Clock::now();
            waiting.again();
        } else if (const auto end = options.stay ? std::nullopt : collector.ended()) {
            writer.finish(end->empty() ? "end of source" : "end of source: " + *end);
            return exit_code_at_end("record", *end);
        } else if (timeout && Clock::now() - last >= *timeout) {
            writer.finish("nothing came");
            return fail("record", hive::Errc::timeout,
                        "no event for " + duration_text(*timeout / 1us) + "; " + reason());
        }
        writer.look(Clock::now());
    }
    const bool early = writer.ended().empty() && (options.count > 0 || options.seconds);
    return early ? interrupt::exit_code() : exit_code::done;
}

/// Events that arrived before the end are part of the recording.
void take_rest(hive::Collector& collector, hive::recording::Writer& writer)
{
    const auto now = Clock::now();
    for (auto event = collector.next(0ms); event && event->received < now && writer.ended().empty();
         event = collector.next(0ms))
        hive::recording::append(writer, *event);
}

void note_losses(hive::Application& application, const hive::Collector& collector, hive::recording::Writer& writer)
{
    for (const auto& loss : losses_now(application, collector.inputs()))
        writer.lost(loss.from, loss.reason, loss.events);
    if (const auto dropped = collector.counts().dropped; dropped > 0)
        writer.lost("*", "dropped by hivectl: it could not keep up", dropped);
}

void summarize(const std::string& file, const hive::recording::Writer& writer, bool json)
{
    const auto& summary = writer.summary();
    hive::Json lost = hive::Json::array();
    for (const auto& loss : summary.lost) {
        lost.push_back({{"from", loss.from}, {"reason", loss.reason}, {"events", loss.events}});
        complain("record", "lost: " + printable(loss.from) + ": " + count_text(loss.events, "event") + ", "
                               + printable(loss.reason));
    }
    const auto outputs = static_cast<std::int64_t>(hive::recording::ports_of(summary.tracks).size());
    const Row row{{"file", file},
                  {"events", summary.events()},
                  {"outputs", outputs},
                  {"duration_us", summary.duration_us},
                  {"bytes", writer.size()},
                  {"ended", summary.ended},
                  {"lost", lost}};
    write_out(json ? row.json() + "\n"
                   : printable(file) + ": " + count_text(summary.events(), "event") + " of "
                         + count_text(outputs, "output") + " in " + duration_text(summary.duration_us) + ", "
                         + size_text(static_cast<std::int64_t>(writer.size()))
                         + (!lost.empty()              ? "; what was lost is listed above\n"
                            : writer.failure().empty() ? ", nothing lost\n"
                                                       : "\n"));
}

int exit_code_for(int code, const hive::recording::Writer& writer)
{
    const bool any = writer.summary().events() > 0;
    if (!writer.failure().empty())
        complain("record", writer.failure() + "; earlier events are in the file");
    if (!writer.failure().empty())
        return any ? exit_code::partly_done : exit_code::failure;
    return writer.summary().lossless() || code != exit_code::done ? code : exit_code::partly_done;
}

int run(const Options& options, Session& session)
{
    std::signal(SIGXFSZ, SIG_IGN);  // exceeding the process's file size limit is an ordinary error
    auto& application = session.application();
    Outcome outcome("record");
    const auto outputs = outputs_of(application, options.names, outcome);
    if (outputs.empty())
        return outcome.exit_code();
    const auto collector = application.collect(outputs, collecting(options));
    hive::recording::Writer writer({.path = options.file,
                                    .overwrite = options.overwrite,
                                    .limits = {static_cast<std::uint64_t>(options.max_size * 1e6), {}}});
    const interrupt::Deferred deferred;
    const int code = [&] {
        Progress progress(application, false);
        Waiting waiting(names_text(texts_of(outputs)));
        return take_events(*collector, writer, progress, waiting, options, session.given_timeout(),
                           [&] { return silence_reason(application, outputs); });
    }();
    note_losses(application, *collector, writer);
    take_rest(*collector, writer);
    writer.finish("stopped");
    summarize(options.file, writer, session.json);
    return outcome.exit_code(exit_code_for(code, writer));
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.names, "drones (all of their outputs), drone.output, or globs").required();
    line.option("-o,--output", options.file, "the file to write").type_name("FILE").required();
    line.option("-n", options.count, "end after this many events").count();
    line.option("--for", options.seconds, "end after this long").type_name("SECONDS").seconds();
    line.option("--max-size", options.max_size, "end before the file grows larger")
        .type_name("MB")
        .megabytes(0.001, 1e9);
    line.flag("--stay", options.stay, "keep waiting after every source has ended");
    line.flag("--overwrite", options.overwrite, "replace the file if it is there");
    const auto notify = line.flag("--notify", options.notify, "headers without bodies");
    const auto stream = line.flag("--stream", options.stream,
                                  "receive every event through the sender's queue, which drops events when full");
    line.option("--window", options.window, "events to request ahead; further ones are skipped (default 64)")
        .type_name("N")
        .between(1, 64)
        .excludes(stream);
    line.option("--encoding", options.encoding, "image encoding: raw, png, jpeg or jpeg:QUALITY (default: unchanged)")
        .type_name("NAME")
        .excludes(notify);
}

}  // namespace

Verb verb()
{
    return {.name = "record",
            .group = "recordings",
            .usage = "NAME[.OUTPUT]... -o FILE [-n N] [--for SECONDS] [options]",
            .summary = "Records the events of drones to a file",
            .details = "Records until every source ends, until Ctrl-C, or up to -n, --for or --max-size. Each event is "
                       "stored with its header, body, identity and arrival time. If the recorder is killed, the file "
                       "can be read up to its last event. If anything is missing from the file, stderr and the end of "
                       "the file report how much and why, and the exit code is 8.",
            .examples = "hivectl record camera face.faces -o run.hive --for 10\n"
                        "hivectl record camera -o small.hive --encoding jpeg:90  until Ctrl-C\n"
                        "hivectl record '*' -o headers.hive --notify -n 1000",
            .timeout = "give up after this long without an event (default: never)",
            .operands = {Operand::sender},
            .declare = with(declare, run)};
}

}  // namespace hivectl::record_verb
