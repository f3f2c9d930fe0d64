// hivectl record: what outputs send goes into a file, and what is missing in it is said.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../format.hpp"
#include "../interrupt.hpp"
#include "../output.hpp"
#include "../session.hpp"
#include "../silence.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

#include <hive/recording/event_record.hpp>

#include <array>
#include <csignal>
#include <unistd.h>

namespace hivectl {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Options {
    std::vector<std::string> names;
    std::string file, encoding;
    std::int64_t count = 0;  // 0: without end
    std::optional<double> seconds;
    double max_size = 0;
    int window = 64;
    bool notify = false, stream = false, overwrite = false;
};

/// A drone without a port means all of its outputs.
std::vector<hive::Endpoint> outputs_named(hive::Application& application, const std::vector<std::string>& names)
{
    std::vector<hive::Endpoint> outputs;
    for (const auto& end : endpoints_named(application, names)) {
        if (!end.port.empty())
            outputs.push_back(end);
        else
            for (const auto& port : application.describe(end.drone).outputs)
                outputs.push_back({end.drone, port.name});
    }
    if (outputs.empty())
        throw hive::Error(hive::Errc::not_found, "there is no output to record",
                          "see the ports: hivectl describe NAME");
    return outputs;
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

/// How it ended is in the writer; the exit code tells about what else went wrong.
int take_events(hive::Collector& collector, hive::recording::Writer& writer, const Options& options,
                std::optional<std::chrono::milliseconds> patience, const std::function<std::string()>& reason)
{
    const auto limit = options.seconds
                           ? Clock::now() + std::chrono::microseconds(static_cast<std::int64_t>(*options.seconds * 1e6))
                           : Clock::time_point::max();
    auto last = Clock::now();
    while (writer.ended().empty() && !interrupt::requested()) {
        if (Clock::now() >= limit) {
            writer.finish("time over");
        } else if (const auto event = collector.next(100ms)) {
            if (event->received < limit)
                hive::recording::append(writer, *event);
            if (writer.summary().events() == options.count)
                writer.finish("count reached");
            last = Clock::now();
        } else if (patience && Clock::now() - last >= *patience) {
            complain("record", "nothing came for " + duration_text(*patience / 1us) + "; " + reason());
            writer.finish("nothing came");
            return exit_code::timed_out;
        }
        writer.look(Clock::now());
    }
    const bool early = writer.ended().empty() && (options.count > 0 || options.seconds);
    return early ? interrupt::exit_code() : exit_code::done;
}

/// What had come before the end is part of the recording.
void take_rest(hive::Collector& collector, hive::recording::Writer& writer)
{
    const auto now = Clock::now();
    for (auto event = collector.next(0ms); event && event->received < now && writer.ended().empty();
         event = collector.next(0ms))
        hive::recording::append(writer, *event);
}

constexpr std::array losses{
    std::pair{hive::Fate::skipped, "skipped by the sender: not asked for in time"},
    std::pair{hive::Fate::dropped, "dropped by the sender: the queue was full"},
    std::pair{hive::Fate::abandoned, "given up by the sender"},
    std::pair{hive::Fate::lost_connection, "under way when the connection broke"},
    std::pair{hive::Fate::lost_cut_off, "under way when hivectl was cut off: it had fallen silent"},
    std::pair{hive::Fate::lost_left, "under way when hivectl left"},
};

/// What the sender of an output says about us.
void note_sender(const hive::Endpoint& output, const hive::StatusAnswer& answer, hive::recording::Writer& writer)
{
    if (answer.error)
        return writer.lost(to_text(output), "not known: " + output.drone + " did not answer at the end", 0);
    const std::string own_name = "app-" + std::to_string(::getpid());
    for (const auto& row : answer.status.outputs)
        for (const auto& edge : row.edges) {
            if (row.name != output.port || edge.receiver != own_name)
                continue;
            for (const auto& [fate, reason] : losses)
                if (const auto count = edge.events.of(fate); count > 0)
                    writer.lost(to_text(output), reason, count);
        }
}

void note_losses(const std::vector<hive::Endpoint>& outputs, hive::Application& application,
                 const hive::Collector& collector, hive::recording::Writer& writer)
{
    std::vector<std::string> drones;
    for (const auto& output : outputs)
        drones.push_back(output.drone);
    const auto answers = application.status(drones);
    for (std::size_t i = 0; i < outputs.size(); ++i)
        note_sender(outputs[i], answers[i], writer);
    if (const auto dropped = collector.counts().dropped; dropped > 0)
        writer.lost("*", "dropped by hivectl: not taken in time", dropped);
}

void summarize(const std::string& file, const hive::recording::Writer& writer, bool json)
{
    const auto& summary = writer.summary();
    hive::Json lost = hive::Json::array();
    for (const auto& loss : summary.lost) {
        lost.push_back({{"from", loss.from}, {"reason", loss.reason}, {"events", loss.events}});
        complain("record", "lost: " + printable(loss.from) + ": "
                               + (loss.events > 0 ? count_text(loss.events, "event") + ", " : "")
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
                         + (lost.empty() ? ", nothing lost\n" : ", and what is lost is said above\n"));
}

int exit_code_for(int code, const hive::recording::Writer& writer)
{
    const bool any = writer.summary().events() > 0;
    if (!writer.failure().empty())
        complain("record", writer.failure() + "; the file holds what came before");
    if (!writer.failure().empty() && !any)
        return exit_code::failure;
    return writer.summary().lossless() || code != exit_code::done ? code : exit_code::partly_done;
}

int run(const Options& options, Session& session)
{
    std::signal(SIGXFSZ, SIG_IGN);  // a file over the limit of the process is an error like others
    auto& application = session.application();
    const auto outputs = outputs_named(application, options.names);
    const auto collector = application.collect(outputs, collecting(options));
    hive::recording::Writer writer({.path = options.file,
                                    .overwrite = options.overwrite,
                                    .limits = {static_cast<std::uint64_t>(options.max_size * 1e6), {}}});
    const interrupt::Deferred deferred;
    const int code = take_events(*collector, writer, options, session.patience(),
                                 [&] { return reason_for_silence(application, outputs); });
    note_losses(outputs, application, *collector, writer);
    take_rest(*collector, writer);
    writer.finish("stopped");
    summarize(options.file, writer, session.json);
    return exit_code_for(code, writer);
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->names, "drones (all of their outputs), drone.output, or globs").required();
    line.option("-o,--output", options->file, "where to").type_name("FILE").required();
    line.option("-n", options->count, "end after this many events")
        .type_name("N")
        .between(std::int64_t{1}, std::int64_t{1} << 53);
    line.option("--for", options->seconds, "end after this long").type_name("SECONDS").seconds();
    line.option("--max-size", options->max_size, "end before the file grows larger")
        .type_name("MB")
        .between(0.001, 1e9);
    line.flag("--overwrite", options->overwrite, "replace the file if it is there");
    const auto notify = line.flag("--notify", options->notify, "headers without bodies");
    const auto stream = line.flag("--stream", options->stream,
                                  "be sent every event, through the sender's queue; what it cannot hold is dropped");
    line.option("--window", options->window, "how many to ask for ahead: what comes beyond is skipped (default 64)")
        .type_name("N")
        .between(1, 64)
        .excludes(stream);
    line.option("--encoding", options->encoding,
                "how pictures are recorded: raw, png, jpeg or jpeg:QUALITY (default: as they are)")
        .type_name("NAME")
        .excludes(notify);
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb record_verb()
{
    return {.name = "record",
            .group = "keep",
            .usage = "NAME[.OUTPUT]... -o FILE [-n N] [--for SECONDS] [options]",
            .summary = "Records what drones send into a file",
            .details = "Until Ctrl-C, or as -n, --for and --max-size say. Every event is kept whole: header, body, "
                       "identity, time of arrival. A recorder "
                       "that is killed leaves a file that can be read to its last event. If anything that was sent is "
                       "not in the file, stderr and "
                       "the file say how much and why, and the exit code is 8.",
            .examples = "hivectl record camera face.faces -o run.hive --for 10\n"
                        "hivectl record camera -o small.hive --encoding jpeg:90  until Ctrl-C\n"
                        "hivectl record '*' -o headers.hive --notify -n 1000",
            .timeout = "give up when nothing came for this long (default: never)",
            .operands = {Operand::sender},
            .declare = declare};
}

}  // namespace hivectl
