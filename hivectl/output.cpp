// Writing to the two streams, and escapes for texts that came from other processes.
#include "output.hpp"

#include <hive/error.hpp>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <unistd.h>

namespace hivectl {
namespace {

/// A code point and how many bytes it took; -1 and 1 for a byte that begins no valid UTF-8.
struct CodePoint {
    std::int32_t value;
    std::size_t bytes;
};

CodePoint code_point(std::string_view text)
{
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char first = byte(0);
    if (first < 0x80)
        return {first, 1};
    const std::size_t length = first >= 0xF0 && first <= 0xF4 ? 4 : first >= 0xE0 ? 3 : 2;
    if (first < 0xC2 || first > 0xF4 || text.size() < length)
        return {-1, 1};
    std::int32_t value = first & (0x7F >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0) != 0x80)
            return {-1, 1};
        value = value << 6 | (byte(i) & 0x3F);
    }
    return {value, length};
}

bool steers_terminal(std::int32_t c)
{
    return c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0x200E || c == 0x200F || (c >= 0x2028 && c <= 0x202E)
           || (c >= 0x2066 && c <= 0x2069);
}

std::string escape(const char* format, unsigned value)
{
    char text[12];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

/// `text` with `replace(code point, bytes)` in place of everything that steers a terminal or is no UTF-8.
template <class Replace>
std::string escaped(std::string_view text, Replace replace)
{
    std::string result;
    while (!text.empty()) {
        const auto [value, bytes] = code_point(text);
        result += steers_terminal(value) ? replace(value, text.substr(0, bytes)) : std::string(text.substr(0, bytes));
        text.remove_prefix(bytes);
    }
    return result;
}

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

void write_out(std::string_view text) { write_all(STDOUT_FILENO, text); }

void complain(std::string_view verb, std::string_view text)
{
    const std::string line =
        "hivectl" + (verb.empty() ? "" : " " + std::string(verb)) + ": " + std::string(text) + "\n";
    // Nobody is left to be told when stderr fails.
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, line.data(), line.size());
}

bool on_terminal() { return ::isatty(STDOUT_FILENO) == 1; }

std::string printable(std::string_view text)
{
    return escaped(text, [](std::int32_t c, std::string_view bytes) -> std::string {
        if (c == '\n')
            return "\\n";
        if (c == '\t')
            return "\\t";
        if (c > 0x9F)
            return escape("\\u%04x", static_cast<unsigned>(c));
        return escape("\\x%02x", c < 0 ? static_cast<unsigned char>(bytes[0]) : static_cast<unsigned>(c));
    });
}

std::string json_text(const hive::Json& value)
{
    return escaped(hive::to_text(value),
                   [](std::int32_t c, std::string_view) { return escape("\\u%04x", static_cast<unsigned>(c)); });
}

std::string bare(const hive::Json& value)
{
    if (!value.is_string())
        return json_text(value);
    const auto text = value.get<std::string>();
    return on_terminal() ? printable(text) : text;
}

}  // namespace hivectl
