// hivectl snap: saves one image.
#include "../verbs.hpp"
#include "run/silence.hpp"
#include "words/media_type.hpp"
#include "words/raw_image.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <hive/platform/whole_file.hpp>

#include <cerrno>
#include <fstream>
#include <optional>

namespace hivectl::snap_verb {
namespace {

struct Options {
    std::string from, file;
};

/// Requests the encoding of the file's extension; an output without encodings sends its own format.
std::unique_ptr<hive::Collector> collect(const hive::Endpoint& output, const std::string& file, Session& session)
{
    hive::CollectOptions options;
    options.connection.window = 1;
    options.connection.first_frame = true;
    options.connection.encoding = media_type_of(file) == "image/png" ? "png" : "jpeg";
    try {
        return session.application().collect({output}, options);
    } catch (const hive::Error& error) {
        if (error.code() != hive::Errc::invalid_argument)
            throw;
        options.connection.encoding.clear();
        return session.application().collect({output}, options);
    }
}

hive::Event next_event(const hive::Endpoint& output, const std::string& file, Session& session)
{
    const auto collector = collect(output, file, session);
    std::optional<Waiting> waiting(to_text(output) + " to send");
    const auto event = collector->next(session.timeout());
    waiting.reset();
    if (const auto end = event ? std::nullopt : collector->ended())
        throw hive::Error(hive::Errc::not_found, to_text(output) + " has ended" + (end->empty() ? "" : ": " + *end),
                          "start its source again");
    if (!event)
        throw hive::Error(hive::Errc::timeout, to_text(output) + " sent nothing in time",
                          silence_reason(session.application(), {output}));
    if (event->body.empty())
        throw hive::Error(hive::Errc::not_found, to_text(output) + " sends events without a body",
                          "read them: hivectl results " + to_text(output));
    return *event;
}

/// Keeps links; writes to a pipe or /dev/null in place.
void save(const std::filesystem::path& named, const hive::Body& body)
{
    namespace fs = std::filesystem;
    const auto file = !fs::is_symlink(named) ? named
                      : fs::exists(named)    ? fs::canonical(named)
                                             : named.parent_path() / fs::read_symlink(named);
    const std::string_view bytes(reinterpret_cast<const char*>(body.data()), body.size());
    std::error_code problem;
    if (!fs::exists(file) || fs::is_regular_file(file))
        problem = hive::platform::write_whole(file, bytes, {.mode = 0666});
    else if (!(std::ofstream(file, std::ios::binary) << bytes).flush())
        problem = {errno, std::generic_category()};
    if (problem)
        throw hive::Error(hive::Errc::io, "cannot write " + printable(named.string()) + ": " + problem.message());
}

/// Raw pixels need their header, which a file does not have.
hive::Event as_file(hive::Event event)
{
    if (event.type != "image/raw")
        return event;
    event.body = png_of(event.header, event.body);
    event.type = "image/png";
    return event;
}

/// The content must match the file's extension.
void require_fitting(const std::filesystem::path& file, const std::string& type, const std::string& output)
{
    if (ending_fits(file, type))
        return;
    auto better = file;
    better.replace_extension(ending_of(type));
    throw hive::Error(hive::Errc::invalid_argument,
                      output + " sends " + printable(type) + ", which " + printable(file.string()) + " does not say",
                      "name the file " + printable(better.string()));
}

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    const auto output = output_named(application, options.from, "image/");
    const auto event = as_file(next_event(output, options.file, session));
    if (options.file == "-") {
        write_out({reinterpret_cast<const char*>(event.body.data()), event.body.size()});
        return exit_code::done;
    }
    require_fitting(options.file, event.type, to_text(output));
    save(options.file, event.body);
    if (session.json)
        write_out(Row{{"file", options.file},
                      {"type", event.type},
                      {"size", event.body.size()},
                      {"source", event.identity.source},
                      {"epoch", event.identity.epoch},
                      {"seq", event.identity.sequence},
                      {"header", event.header}}
                      .json()
                  + "\n");
    return exit_code::done;
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.from, "drone or drone.output; omit the output if only one sends images").required();
    line.option("FILE", options.file, "file; - is stdout").required();
}

}  // namespace

Verb verb()
{
    return {.name = "snap",
            .group = "results",
            .usage = "NAME[.OUTPUT] FILE [options]",
            .summary = "Saves one image from a drone",
            .details = "Saves a PNG if the file name ends in .png, otherwise a JPEG. Raw pixels of a drone without "
                       "encodings are saved as PNG, and other events unchanged. If the extension means another type, "
                       "nothing is written. Replaces an existing file.",
            .examples = "hivectl snap camera now.jpg\n"
                        "hivectl snap face.annotated faces.png",
            .operands = {Operand::sender, Operand::file},
            .declare = with(declare, run)};
}

}  // namespace hivectl::snap_verb
