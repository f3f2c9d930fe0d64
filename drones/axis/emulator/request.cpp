// Parses the request line, its query, and the two fields that matter.
#include "request.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace axis::emulator {
namespace {

std::string decoded(std::string_view text)
{
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned byte = 0;
        const bool escape = text[i] == '%' && i + 2 < text.size();
        if (escape && std::from_chars(text.data() + i + 1, text.data() + i + 3, byte, 16).ec == std::errc()) {
            result += static_cast<char>(byte);
            i += 2;
        } else {
            result += text[i] == '+' ? ' ' : text[i];
        }
    }
    return result;
}

std::string_view next_line(std::string_view& text)
{
    const std::size_t end = std::min(text.find("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 2, text.size()));
    return line;
}

/// The value of a field, if the line has it. @param name  in lower case, with the colon
std::optional<std::string> field(std::string_view line, std::string_view name)
{
    const bool is = line.size() >= name.size()
                    && std::ranges::equal(line.substr(0, name.size()), name, {},
                                          [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (!is)
        return std::nullopt;
    line.remove_prefix(name.size());
    line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    return std::string(line);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> parse_query(std::string_view text)
{
    std::vector<std::pair<std::string, std::string>> words;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('&'), text.size());
        const std::string_view one = text.substr(0, end);
        const std::size_t equals = std::min(one.find('='), one.size());
        words.emplace_back(decoded(one.substr(0, equals)), decoded(one.substr(std::min(equals + 1, one.size()))));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return words;
}

std::string Request::word(std::string_view name) const
{
    const auto found = std::ranges::find_if(query, [&](const auto& one) { return one.first == name; });
    return found == query.end() ? "" : found->second;
}

std::optional<Request> parse_request(std::string_view head)
{
    const std::string_view first = next_line(head);
    const std::size_t space = first.find(' '), last = first.rfind(' ');
    if (space == std::string_view::npos || last <= space + 1 || !first.substr(last + 1).starts_with("HTTP/1."))
        return std::nullopt;
    Request request;
    request.method = first.substr(0, space);
    request.target = first.substr(space + 1, last - space - 1);
    request.path = request.target.substr(0, request.target.find('?'));
    if (request.path.size() < request.target.size())
        request.query = parse_query(std::string_view(request.target).substr(request.path.size() + 1));
    while (!head.empty()) {
        const std::string_view line = next_line(head);
        if (const auto authorization = field(line, "authorization:"))
            request.authorization = *authorization;
        if (const auto length = field(line, "content-length:"))
            std::from_chars(length->data(), length->data() + length->size(), request.body_size);
    }
    return request;
}

}  // namespace axis::emulator
