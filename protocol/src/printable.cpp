// Decodes code points, and replaces those that control a terminal.
#include <hive/printable.hpp>

#include <cstdio>

namespace hive {
namespace {

/// A code point and its number of bytes; -1 and 1 for a byte that begins no valid UTF-8.
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

std::string number(const char* format, unsigned value)
{
    char text[12];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

}  // namespace

std::string shortened(std::string_view text, std::size_t most)
{
    constexpr std::string_view dots = "\xE2\x80\xA6";
    if (text.size() <= most)
        return std::string(text);
    auto end = most - dots.size();
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
        --end;
    return std::string(text.substr(0, end)) + std::string(dots);
}

std::string escaped(std::string_view text, const Escape& replace)
{
    std::string result;
    while (!text.empty()) {
        const auto [value, bytes] = code_point(text);
        result += steers_terminal(value) ? replace(value, text.substr(0, bytes)) : std::string(text.substr(0, bytes));
        text.remove_prefix(bytes);
    }
    return result;
}

std::string printable(std::string_view text)
{
    return escaped(text, [](std::int32_t c, std::string_view bytes) -> std::string {
        if (c == '\n')
            return "\\n";
        if (c == '\t')
            return "\\t";
        if (c > 0x9F)
            return number("\\u%04x", static_cast<unsigned>(c));
        return number("\\x%02x", c < 0 ? static_cast<unsigned char>(bytes[0]) : static_cast<unsigned>(c));
    });
}

}  // namespace hive
