// hivectl snap: saves one picture.
#include "../command_line.hpp"
#include "../exit_code.hpp"
#include "../media_type.hpp"
#include "../output.hpp"
#include "../session.hpp"
#include "../table.hpp"
#include "../targets.hpp"
#include "../verbs.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <unistd.h>

namespace hivectl {
namespace {

struct Options {
    std::string from, file;
};

hive::Event next_event(const hive::Endpoint& output, Session& session)
{
    hive::CollectOptions options;
    options.connection.window = 1;
    options.connection.first_frame = true;
    const auto collector = session.application().collect({output}, options);
    const auto event = collector->next(session.timeout());
    if (!event)
        throw hive::Error(hive::Errc::timeout, to_text(output) + " sent nothing in time; is it fed? see hivectl edges, or allow more time: --timeout SECONDS");
    if (event->body.empty())
        throw hive::Error(hive::Errc::not_found, to_text(output) + " sends events without a body; read them: hivectl results " + to_text(output));
    return *event;
}

/// Beside the file first, then renamed: nobody sees half of it.
void save(const std::filesystem::path& file, const hive::Body& body)
{
    const std::filesystem::path part = file.string() + "." + std::to_string(::getpid()) + ".part";
    std::ofstream out(part, std::ios::binary);
    out.write(reinterpret_cast<const char*>(body.data()), static_cast<std::streamsize>(body.size()));
    out.close();
    std::error_code problem;
    if (out)
        std::filesystem::rename(part, file, problem);
    if (out && !problem)
        return;
    const std::string reason = problem ? problem.message() : std::strerror(errno);
    std::filesystem::remove(part, problem);
    throw hive::Error(hive::Errc::io, "cannot write " + printable(file.string()) + ": " + reason);
}

int run(const Options& options, Session& session)
{
    auto& application = session.application();
    auto output = application.endpoint(options.from);
    if (output.port.empty())
        output.port = usual_output(application.describe(output.drone), output.drone, "image/");
    const auto event = next_event(output, session);
    if (options.file == "-") {
        write_out({reinterpret_cast<const char*>(event.body.data()), event.body.size()});
        return exit_code::done;
    }
    if (!ending_fits(options.file, event.type))
        complain("snap", printable(options.file) + " holds " + printable(event.type) + ", which its ending does not say; it is saved as it came");
    save(options.file, event.body);
    if (session.json)
        write_out(Row{{"file", options.file}, {"type", event.type}, {"size", event.body.size()}, {"source", event.identity.source},
                      {"epoch", event.identity.epoch}, {"seq", event.identity.sequence}, {"header", event.header}}.json() + "\n");
    return exit_code::done;
}

Run declare(CLI::App& app, Session& session)
{
    auto options = std::make_shared<Options>();
    app.add_option("NAME", options->from, "drone or drone.output; the output goes without saying when only one sends pictures")->required();
    app.add_option("FILE", options->file, "where to; - is stdout")->required();
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb snap_verb()
{
    return {.name = "snap",
            .group = "look",
            .usage = "NAME[.OUTPUT] FILE [options]",
            .summary = "Saves one picture that a drone sends",
            .details = "The body is saved as it came, whatever its type; a warning says so if the file's ending means another. A file "
                       "that is there already is replaced.",
            .examples = "hivectl snap camera now.jpg\n"
                        "hivectl snap face.annotated faces.jpg",
            .operands = {Operand::sender, Operand::file},
            .declare = declare};
}

}  // namespace hivectl
