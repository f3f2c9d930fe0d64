// Writes to stdout and stderr.
#include "words/output.hpp"

#include "words/status_line.hpp"

#include <hive/error.hpp>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <optional>
#include <sstream>
#include <unistd.h>

namespace hivectl {
namespace {

void write_all(int descriptor, std::string_view text)
{
    while (!text.empty()) {
        const auto written = ::write(descriptor, text.data(), text.size());
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0 && errno == EPIPE) {
            std::signal(SIGPIPE, SIG_DFL);
            std::raise(SIGPIPE);
        }
        if (written < 0)
            throw hive::Error(hive::Errc::io, std::string("cannot write to standard output: ") + std::strerror(errno));
        text.remove_prefix(static_cast<std::size_t>(written));
    }
}

}  // namespace

void write_out(std::string_view text)
{
    status_line::take_over();
    std::optional<status_line::Interruption> interruption;
    if (on_terminal())
        interruption.emplace();
    write_all(STDOUT_FILENO, text);
}

void complain(std::string_view verb, std::string_view text)
{
    write_error("hivectl" + (verb.empty() ? "" : " " + std::string(verb)) + ": " + std::string(text) + "\n");
}

void complain_in_lines(std::string_view verb, const std::string& text)
{
    std::istringstream lines(text);
    std::string indent;
    for (std::string line; std::getline(lines, line); indent = "  ")
        complain(verb, indent + printable(line));
}

void write_error(std::string_view text)
{
    const status_line::Interruption interruption;
    // A failure of stderr cannot be reported.
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
}

bool on_terminal() { return ::isatty(STDOUT_FILENO) == 1; }

std::string json_text(const hive::Json& value)
{
    return hive::escaped(hive::to_text(value), [](std::int32_t c, std::string_view) {
        char text[12];
        std::snprintf(text, sizeof text, "\\u%04x", static_cast<unsigned>(c));
        return std::string(text);
    });
}

std::string bare(const hive::Json& value)
{
    if (!value.is_string())
        return json_text(value);
    const auto text = value.get<std::string>();
    return on_terminal() ? printable(text) : text;
}

}  // namespace hivectl
