// Rows and files of kept failures.
#include "run/kept_inputs.hpp"

#include "words/media_type.hpp"
#include "words/output.hpp"
#include "words/raw_image.hpp"

#include <hive/error.hpp>
#include <hive/event_text.hpp>
#include <hive/rerun.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace hivectl {
namespace {

/// Body and extension; raw pixels other than 8 bit are not converted.
std::pair<hive::Body, std::string> as_file(const hive::Event& event)
{
    try {
        if (event.type == "image/raw")
            return {png_of(event.header, event.body), ".png"};
    } catch (const hive::Error&) {
        // The drone may have failed because the image is invalid.
    }
    const auto ending = ending_of(event.type);
    return {event.body, ending.empty() || ending == ".json" ? ".bin" : ending};
}

hive::Json about(const hive::KeptFailure& failure, const hive::Event& event, const std::string& body)
{
    hive::Json json{{"drone", failure.drone},
                    {"number", failure.number},
                    {"time_us", failure.time_us},
                    {"code", failure.code},
                    {"text", failure.text},
                    {"input", event.input},
                    {"event", hive::parse_json(hive::event_text(event))}};
    if (!body.empty())
        json["body"] = body;
    return json;
}

}  // namespace

void write_new(const std::filesystem::path& file, std::string_view bytes)
{
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (descriptor < 0 && errno == EEXIST)
        throw hive::Error(hive::Errc::refused, printable(file.string()) + " already exists",
                          "choose another name, or another directory");
    bool written = descriptor >= 0;
    while (written && !bytes.empty()) {
        const auto count = ::write(descriptor, bytes.data(), bytes.size());
        written = count > 0;
        bytes.remove_prefix(written ? static_cast<std::size_t>(count) : 0);
    }
    const int error = errno;
    if (descriptor >= 0)
        ::close(descriptor);
    if (!written)
        throw hive::Error(hive::Errc::io, "cannot write " + printable(file.string()) + ": " + std::strerror(error));
}

Row failure_row(const hive::KeptFailure& failure)
{
    std::string inputs;
    std::size_t bytes = 0;
    for (const auto& event : failure.inputs) {
        bytes += event.size;
        inputs += (inputs.empty() ? "" : ",") + event.input;
    }
    const auto first = failure.inputs.empty() ? hive::Event() : failure.inputs.front();
    return {{"drone", failure.drone},
            {"number", failure.number},
            {"time_us", failure.time_us},
            {"code", failure.code},
            {"input", inputs},
            {"sender", first.sender.empty() ? "" : first.sender + "." + first.output},
            {"source", first.identity.source},
            {"seq", first.identity.sequence},
            {"kept", bytes},
            {"text", failure.text}};
}

std::vector<std::string> save_failure(hive::Application& application, const hive::KeptFailure& failure,
                                      const std::filesystem::path& directory)
{
    std::error_code ignored;
    std::filesystem::create_directories(directory, ignored);  // a failure shows when the first file is written
    std::vector<std::string> files, names;
    for (const auto& event : failure.inputs) {
        auto name = failure.drone + "-" + std::to_string(failure.number) + "." + event.input;
        const auto same = std::ranges::count(names, name);
        names.push_back(name);
        name += same > 0 ? "-" + std::to_string(same + 1) : "";
        const auto [body, ending] = as_file(event);
        const auto body_file = body.empty() ? std::string() : name + ending;
        if (!body.empty()) {
            write_new(directory / body_file, {reinterpret_cast<const char*>(body.data()), body.size()});
            files.push_back(body_file);
        }
        write_new(directory / (name + ".json"), about(failure, event, body_file).dump(2) + "\n");
        files.push_back(name + ".json");
    }
    files.push_back(failure.drone + "-" + std::to_string(failure.number) + ".failure");
    write_new(directory / files.back(), hive::failure_file(application, failure));
    return files;
}

}  // namespace hivectl
