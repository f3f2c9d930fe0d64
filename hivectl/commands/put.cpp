// hivectl put: sends one file into a drone.
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
#include <iostream>

namespace hivectl {
namespace {

constexpr std::size_t most_bytes = 1024ull * 1024 * 1024;  // no drone takes more, whatever its operator allows

struct Options {
    std::string to, file, type, header = "{}";
};

std::string content_of(std::istream& in, const std::string& file)
{
    std::string content;
    std::vector<char> block(1 << 20);
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0) {
        content.append(block.data(), static_cast<std::size_t>(in.gcount()));
        if (content.size() > most_bytes)
            throw hive::Error(hive::Errc::too_large, printable(file) + " is larger than 1 GiB");
    }
    if (in.bad())
        throw hive::Error(hive::Errc::io, "cannot read " + printable(file) + ": " + std::strerror(errno));
    return content;
}

std::string content_of(const std::string& file)
{
    if (file == "-")
        return content_of(std::cin, "stdin");
    if (std::filesystem::is_directory(file))
        throw hive::Error(hive::Errc::io, "cannot read " + printable(file) + ": it is a directory");
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw hive::Error(hive::Errc::io, "cannot read " + printable(file) + ": " + std::strerror(errno));
    return content_of(in, file);
}

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
    if (type.empty())
        throw hive::Error(hive::Errc::invalid_argument,
                          "the ending of " + printable(options.file) + " says no media type",
                          "add for example --type image/jpeg");
    const auto header = header_of(options.header);
    std::string content = content_of(options.file);
    auto& application = session.application();
    auto input = application.endpoint(options.to);
    if (input.port.empty())
        input.port = usual_input(application.describe(input.drone), input.drone, type);
    const auto size = content.size();
    application.put(input, header, hive::Body(std::move(content)), type);
    if (session.json)
        write_out(Row{{"to", to_text(input)}, {"type", type}, {"size", size}}.json() + "\n");
    return exit_code::done;
}

Run declare(CommandLine& line, Session& session)
{
    auto options = std::make_shared<Options>();
    line.option("NAME", options->to, "drone or drone.input; the input may be left out when only one takes the type")
        .required();
    line.option("FILE", options->file, "what to send; - is stdin (then --type is needed)").required();
    line.option("--type", options->type, "its media type (default: from the ending: .jpg .png .bmp .json .txt ...)")
        .type_name("TYPE");
    line.option("--header", options->header, "a JSON object to go with it").type_name("JSON");
    return [options, &session] { return run(*options, session); };
}

}  // namespace

Verb put_verb()
{
    return {.name = "put",
            .group = "look",
            .usage = "NAME[.INPUT] FILE [options]",
            .summary = "Sends one file into a drone, as if another drone had sent it",
            .details = "Returns when the drone has put the file into its queue. The results go to whoever receives "
                       "them; see hivectl results.",
            .examples = "hivectl put face photo.jpg\n"
                        "hivectl put face.image - --type image/png < photo.png",
            .operands = {Operand::receiver, Operand::file},
            .declare = declare};
}

}  // namespace hivectl
