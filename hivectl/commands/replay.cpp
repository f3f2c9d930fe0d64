// hivectl replay: starts a drone that plays a recording, or describes the recording.
#include "../verbs.hpp"
#include "run/launch.hpp"
#include "words/format.hpp"

#include <hive/recording/reader.hpp>

#include <filesystem>

namespace hivectl::replay_verb {
namespace {

struct Options {
    std::string file, name = "replay", pace, speed, from, to;
    bool loop = false, halted = false, info = false;
};

const std::vector<Column> columns{{"OUTPUT", "output"},
                                  {"FROM", "from"},
                                  {"TYPE", "type"},
                                  {"EVENTS", "events"},
                                  {"SIZE", "bytes", as_size},
                                  {"FIRST", "first_us", as_duration},
                                  {"LAST", "last_us", as_duration},
                                  {"WITHOUT BODY", "without_body"}};

std::vector<Row> output_rows(const hive::recording::Summary& summary)
{
    std::vector<Row> rows;
    for (const auto& port : hive::recording::ports_of(summary.tracks))
        for (const auto number : port.tracks) {
            const auto& track = summary.tracks[number];
            rows.push_back({{"output", port.name},
                            {"from", track.from()},
                            {"type", track.type},
                            {"events", track.events},
                            {"bytes", track.bytes},
                            {"first_us", track.first_us},
                            {"last_us", track.last_us},
                            {"without_body", track.without_body}});
        }
    return rows;
}

void print_json(const std::string& file, const hive::recording::Reader& reader)
{
    const auto& summary = reader.summary();
    hive::Json outputs = hive::Json::array(), lost = hive::Json::array();
    for (const auto& row : output_rows(summary))
        outputs.push_back(hive::Json::parse(row.json()));
    for (const auto& loss : summary.lost)
        lost.push_back({{"from", loss.from}, {"reason", loss.reason}, {"events", loss.events}});
    write_out(Row{{"file", file},
                  {"bytes", reader.size()},
                  {"events", summary.events()},
                  {"begun_us", summary.begun_us},
                  {"duration_us", summary.duration_us},
                  {"ended", summary.ended},
                  {"problem", reader.problem()},
                  {"outputs", outputs},
                  {"lost", lost}}
                  .json()
              + "\n");
}

void print_text(const std::string& file, const hive::recording::Reader& reader, const Page& page)
{
    const auto& summary = reader.summary();
    write_out(printable(file) + ": " + count_text(summary.events(), "event") + " in "
              + duration_text(summary.duration_us) + ", " + size_text(static_cast<std::int64_t>(reader.size()))
              + (summary.begun_us > 0 ? ", begun " + time_text(summary.begun_us) : "")
              + (summary.ended.empty() ? "" : ", ended: " + printable(summary.ended)) + "\n");
    write_out(table_text(columns, output_rows(summary), page));
    for (const auto& loss : summary.lost)
        write_out("lost: " + printable(loss.from) + ": "
                  + (loss.events > 0 ? count_text(loss.events, "event") + ", " : "") + printable(loss.reason) + "\n");
}

hive::DroneOrder order_of(const Options& options)
{
    hive::DroneOrder order{.name = options.name, .kind = "replay", .halted = options.halted};
    order.set["file"] = std::filesystem::absolute(options.file).string();
    for (const auto& [key, value] : {std::pair{"pace", options.pace},
                                     {"speed", options.speed},
                                     {"from", options.from},
                                     {"to", options.to},
                                     {"loop", std::string(options.loop ? "on" : "")}})
        if (!value.empty())
            order.set[key] = value;
    return order;
}

int run(const Options& options, Session& session)
{
    const hive::recording::Reader reader(options.file);
    if (!reader.problem().empty())
        complain("replay", printable(options.file) + ": " + reader.problem()
                               + "; whole events before that: " + std::to_string(reader.summary().events()));
    if (options.info) {
        session.json ? print_json(options.file, reader) : print_text(options.file, reader, page_of(session.form()));
        return reader.problem().empty() ? exit_code::done : exit_code::partly_done;
    }
    return start_in_background(session, start_options(session, "replay", order_of(options)));
}

void declare(CommandLine& line, Options& options)
{
    line.option("FILE", options.file, "the recording").required();
    line.option("--as", options.name, "name of the drone in the swarm (default: replay)").type_name("NAME");
    line.option("--pace", options.pace,
                "real: recorded timing (default); demand: next event when all receivers ask, none skipped")
        .type_name("real|demand")
        .one_of({"real", "demand"});
    line.option("--speed", options.speed, "playback speed, 1: as recorded").type_name("FACTOR").between(0.01, 1000.0);
    line.option("--from", options.from, "start at this offset").type_name("SECONDS").seconds(0);
    line.option("--to", options.to, "end there").type_name("SECONDS").seconds();
    line.flag("--loop", options.loop, "repeat at the end");
    line.flag("--halted", options.halted, "wait for hivectl resume, so that everything can be connected first");
    line.flag("--info", options.info, "print what is in the file, and start nothing");
}

}  // namespace

Verb verb()
{
    return {.name = "replay",
            .group = "recordings",
            .usage = "FILE [--as NAME] [--pace real|demand] [--halted] [options]",
            .summary = "Plays a recording as a drone with the recorded outputs",
            .details =
                "Starts the drone and prints its name. Playback starts with the first receiver. Events have their "
                "recorded identities, times and bodies, and outputs their recorded names; if several drones had an "
                "output of one name, it is called DRONE-OUTPUT. With --info, the exit code is 8 if the file was cut "
                "short or its index is damaged; the events themselves are checked during playback.",
            .examples = "hivectl replay run.hive --info\n"
                        "hivectl replay run.hive --pace demand\n"
                        "hivectl connect replay.image face",
            .timeout = "stop it if it does not answer in time (default 10)",
            .table = true,
            .operands = {Operand::file},
            .declare = with(declare, run)};
}

}  // namespace hivectl::replay_verb
