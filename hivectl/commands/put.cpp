// hivectl put: sends one file to a drone.
#include "../verbs.hpp"
#include "words/file_text.hpp"
#include "words/media_type.hpp"
#include "words/status_line.hpp"
#include "words/targets.hpp"

#include <filesystem>

namespace hivectl::put_verb {
namespace {

constexpr std::size_t most_bytes = 1024ull * 1024 * 1024;  // no drone accepts more, whatever its operator allows

struct Options {
    std::string to, file, type, header = "{}";
};

hive::Json header_of(const std::string& text)
{
    constexpr auto example = "write for example --header '{\"page\": 3}'";
    try {
        if (auto header = hive::parse_json(text); header.is_object())
            return header;
    } catch (const hive::Error& error) {
        throw hive::Error(hive::Errc::invalid_argument, std::string("--header: ") + error.what(), example);
    }
    throw hive::Error(hive::Errc::invalid_argument, "--header must be a JSON object", example);
}

int run(const Options& options, Session& session)
{
    const std::string type = options.type.empty() ? media_type_of(options.file) : options.type;
    std::error_code ignored;
    if (type.empty() && (options.file == "-" || std::filesystem::exists(options.file, ignored)))  // else a missing file
        throw hive::Error(hive::Errc::invalid_argument, "unknown media type of " + printable(options.file),
                          "add for example --type image/jpeg");
    const auto header = header_of(options.header);
    std::string content = text_of_file(options.file, most_bytes);
    auto& application = session.application();
    const auto input = input_named(application, options.to, type);
    const auto size = content.size();
    const Waiting waiting(to_text(input) + " to take " + options.file);
    application.put(input, header, hive::Body(std::move(content)), type);
    if (session.json)
        write_out(Row{{"to", to_text(input)}, {"type", type}, {"size", size}}.json() + "\n");
    return exit_code::done;
}

void declare(CommandLine& line, Options& options)
{
    line.option("NAME", options.to, "drone or drone.input; the input may be left out when only one takes the type")
        .required();
    line.option("FILE", options.file, "what to send; - is stdin (then --type is needed)").required();
    line.option("--type", options.type, "media type (default: by extension: .jpg .png .bmp .json .txt ...)")
        .type_name("TYPE");
    line.option("--header", options.header, "a JSON object to go with it").type_name("JSON");
}

}  // namespace

Verb verb()
{
    return {.name = "put",
            .group = "results",
            .usage = "NAME[.INPUT] FILE [options]",
            .summary = "Sends a file to a drone, as if another drone had sent it",
            .details = "Returns once the drone has queued the file. Results go to its receivers; see hivectl results.",
            .examples = "hivectl put face photo.jpg\n"
                        "hivectl put face.image - --type image/png < photo.png",
            .operands = {Operand::receiver, Operand::file},
            .declare = with(declare, run)};
}

}  // namespace hivectl::put_verb
