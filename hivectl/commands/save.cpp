// hivectl save: writes the images of a drone to a video or a folder.
#include "../verbs.hpp"
#include "run/interrupt.hpp"
#include "run/launch.hpp"
#include "run/silence.hpp"
#include "words/format.hpp"
#include "words/progress.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <algorithm>
#include <optional>

namespace hivectl::save_verb {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Options {
    std::string from, file;
    std::int64_t count = 0;  // 0: unlimited
    double fps = 0;
    int quality = 80;
    bool overwrite = false;
};

/// Makes the path absolute; the trailing slash of a folder stays.
std::string path_of(const std::string& file) { return std::filesystem::absolute(file).string(); }

hive::DroneOrder order_of(const Options& options)
{
    return {.name = "writer",
            .kind = "write",
            .set = {{"file", path_of(options.file)},
                    {"quality", options.quality},
                    {"fps", options.fps},
                    {"count", options.count},
                    {"overwrite", options.overwrite ? "on" : "off"}}};
}

/// The number of images that the writer has received, and the source of the sender's last one.
void note_progress(Progress& progress, hive::Application& application, const std::string& writer,
                   const std::string& source)
{
    application.timeout(500ms);
    const auto answer = application.status(std::vector{writer}).at(0);
    const auto* status = value_of(answer.status);
    if (!status)
        return;
    std::int64_t done = 0;
    for (const auto& input : status->inputs)
        done += input.processed;
    progress.note(source, done);
}

/// The source of the chain that leads here, if there is only one.
std::string source_of(hive::Application& application, std::string drone)
{
    for (int hops = 0; hops < 16; ++hops) {
        const auto answer = application.status(std::vector{drone}).at(0);
        const auto* status = value_of(answer.status);
        if (!status || status->inputs.empty())
            break;
        drone = hive::parse_endpoint(status->inputs.front().from).drone;
    }
    return drone;
}

/// The writer's report once the file is complete: after the end of the source, enough images, or Ctrl-C.
std::optional<hive::Event> await(hive::TiedDrone& writer, hive::Collector& files, hive::Application& application,
                                 const hive::Endpoint& output, std::chrono::milliseconds limit)
{
    Progress progress(application, false);
    const auto source = source_of(application, output.drone);
    std::optional<Waiting> waiting;
    bool told = false, ending = false;
    auto until = Clock::time_point::max();
    for (auto since = Clock::now(); Clock::now() < until;) {
        if (auto event = files.next(100ms))
            return event;
        if (writer.exited())
            return std::nullopt;
        if (!ending)
            note_progress(progress, application, writer.name(), source);
        if (!told && Clock::now() - since > 3s) {
            told = true;
            if (const auto explanation = explain_silence(application, {output}); explanation.blocked())
                complain("save", to_text(explanation));
        }
        if (interrupt::requested() && !std::exchange(ending, true)) {
            application.timeout(limit);
            waiting.emplace("the file to be completed");
            application.set(writer.name(), {{"file", ""}});
            until = Clock::now() + limit;
        }
    }
    return std::nullopt;
}

/// Prints the outcome, and returns the exit code.
int report(const hive::Json& header, const Options& options, bool json)
{
    const auto frames = header.value("frames", std::int64_t{0});
    const auto problem = header.value("problem", std::string());
    if (frames == 0)
        return fail("save", hive::Errc::failed, problem.empty() ? "no image arrived; nothing was written" : problem);
    if (!problem.empty())
        complain("save", printable(problem));
    std::error_code ignored;
    const auto size = std::filesystem::is_regular_file(options.file, ignored)
                          ? static_cast<std::int64_t>(std::filesystem::file_size(options.file, ignored))
                          : 0;
    const auto duration = header.value("duration_us", std::int64_t{0});
    write_out(json ? Row{{"file", options.file},
                         {"frames", frames},
                         {"duration_us", duration},
                         {"bytes", size},
                         {"encoder", header.value("encoder", "")},
                         {"ended", header.value("ended", "")},
                         {"problem", problem}}
                             .json()
                         + "\n"
                   : printable(options.file) + ": " + count_text(frames, "frame") + " in " + duration_text(duration)
                         + (size > 0 ? ", " + size_text(size) : "") + ", " + printable(header.value("encoder", ""))
                         + "\n");
    return problem.empty() ? exit_code::done : exit_code::partly_done;
}

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    const auto output = output_named(application, options.from, "image/");
    const interrupt::Deferred deferred;
    auto writer = start_for_verb(session, "save", order_of(options));
    const auto files = application.collect({{writer.name(), "files"}});
    hive::ConnectionOptions connection;
    connection.window = 4;
    connection.encoding = "";
    application.connect(output, {writer.name(), "image"}, connection);
    const auto event = await(writer, *files, application, output, session.timeout(10s));
    if (event)
        return report(event->header, options, session.json);
    if (const auto how = writer.exited())
        throw *how;
    return fail("save", hive::Errc::timeout, "the file was not completed in time; it holds what came before");
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.from, "drone or drone.output; omit the output if only one sends images").required();
    line.option("FILE", options.file, "a video (.mp4 .mov .mkv .avi), or a folder of images (NAME/)").required();
    line.option("-n", options.count, "end after this many images").count(2'000'000'000);
    line.option("--fps", options.fps, "write at this rate (default: keep the time of each image)")
        .type_name("FPS")
        .between(0.0, 1000.0);
    line.option("--quality", options.quality, "of the images (default 80)").type_name("1-100").between(1, 100);
    line.flag("--overwrite", options.overwrite, "replace the file if it is there");
}

}  // namespace

Verb verb()
{
    return {.name = "save",
            .group = "recordings",
            .usage = "NAME[.OUTPUT] FILE [-n N] [options]",
            .summary = "Writes the images of a drone to a video file or a folder",
            .details = "Writes until every source ends, until Ctrl-C, or until N images are written, by running a "
                       "drone of kind write. Each image keeps its time: that in its source file, or of its capture. A "
                       "truncated file is still playable.",
            .examples = "hivectl save face.annotated faces.mp4\n"
                        "hivectl save camera images/ -n 100",
            .timeout = "give up if a drone does not answer in time (default 10)",
            .operands = {Operand::sender, Operand::file},
            .declare = with(declare, run)};
}

}  // namespace hivectl::save_verb
