// Parses lines of name=value, and lines that start with #.
#include "parameter_text.hpp"

#include <algorithm>
#include <cctype>

namespace axis {
namespace {

constexpr std::size_t max_reason = 4000;

/// Is it UTF-8? Good enough to distinguish it from Latin-1: every lead byte has its number of continuation bytes.
bool is_utf8(std::string_view text)
{
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const int more = lead < 0x80                   ? 0
                         : lead >= 0xC2 && lead < 0xE0 ? 1
                         : lead >= 0xE0 && lead < 0xF0 ? 2
                         : lead >= 0xF0 && lead < 0xF5 ? 3
                                                       : -1;
        if (more < 0)
            return false;
        for (int k = 0; k < more; ++k)
            if (++i == text.size() || (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80)
                return false;
    }
    return true;
}

std::string to_utf8(std::string_view text)
{
    if (is_utf8(text))
        return std::string(text);
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80) {
            result += c;
        } else {
            result += static_cast<char>(0xC0 | byte >> 6);
            result += static_cast<char>(0x80 | (byte & 0x3F));
        }
    }
    return result;
}

/// Names, values and reasons are short; longer texts are truncated.
std::string_view cut(std::string_view text)
{
    constexpr std::size_t most = 2000;  // of Latin-1, which becomes twice as long
    auto end = std::min(text.size(), most);
    for (int i = 0; i < 3 && end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80; ++i)
        --end;  // not inside a UTF-8 character
    return text.substr(0, end);
}

std::string_view without_ends(std::string_view line)
{
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())))
        line.remove_suffix(1);
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.front())))
        line.remove_prefix(1);
    return line;
}

bool is_name(std::string_view text)
{
    return !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
        return std::isalnum(c) || c == '.' || c == '_' || c == '-';
    });
}

template <class Take>
void each_line(std::string_view body, Take take)
{
    while (!body.empty()) {
        const std::size_t end = std::min(body.find('\n'), body.size());
        take(without_ends(body.substr(0, end)));
        body.remove_prefix(std::min(end + 1, body.size()));
    }
}

}  // namespace

ParameterList parse_parameters(std::string_view body)
{
    ParameterList list;
    each_line(body, [&](std::string_view line) {
        if (line.starts_with('#'))
            return list.errors.push_back(to_utf8(cut(without_ends(line.substr(1)))));
        const std::size_t equals = line.find('=');
        std::string_view name = line.substr(0, equals);
        if (name.starts_with("root."))
            name.remove_prefix(5);
        if (equals != std::string_view::npos && is_name(name))
            list.values[std::string(name)] = to_utf8(cut(line.substr(equals + 1)));
    });
    return list;
}

std::optional<std::string> refusal_of(std::string_view body)
{
    const ParameterList list = parse_parameters(body);
    std::string text;
    for (const auto& error : list.errors)
        if (text.size() + error.size() < max_reason)
            text += (text.empty() ? "" : "; ") + error;
    if (!text.empty())
        return text;
    const std::string_view all = without_ends(body);
    if (all == "OK")
        return std::nullopt;
    return "the answer is \"" + to_utf8(all.substr(0, std::min<std::size_t>(all.find('\n'), 100))) + "\"";
}

std::string url_encoded(std::string_view text)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte < 0x80 && std::isalnum(byte)) || std::string_view("-._~").find(c) != std::string_view::npos) {
            result += c;
        } else {
            result += '%';
            result += digits[byte >> 4];
            result += digits[byte & 15];
        }
    }
    return result;
}

std::string list_query(const std::vector<std::string>& groups)
{
    std::string query = "action=list&group=";
    for (const auto& group : groups)
        query += (query.ends_with('=') ? "" : ",") + url_encoded(group);
    return query;
}

std::string update_query(const Parameters& values)
{
    std::string query = "action=update";
    for (const auto& [name, value] : values)
        query += "&" + url_encoded(name) + "=" + url_encoded(value);
    return query;
}

}  // namespace axis
