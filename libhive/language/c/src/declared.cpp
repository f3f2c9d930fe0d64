// Names and types of ports must be valid and unique.
#include "declared.hpp"

#include <hive/error.hpp>
#include <hive/name.hpp>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace hive::c {
namespace {

/// A name of RFC 6838, section 4.2.
bool is_restricted_name(std::string_view text)
{
    return !text.empty() && std::ranges::all_of(text, [](char c) {
        return std::isalnum(static_cast<unsigned char>(c))
               || std::string_view("!#$&-^_.+").find(c) != std::string_view::npos;
    });
}

/// `*` stands for any part.
bool is_media_type(std::string_view text)
{
    text = text.substr(0, text.find(';'));
    const auto slash = text.find('/');
    const auto is_part = [](std::string_view part) { return part == "*" || is_restricted_name(part); };
    return slash != std::string_view::npos && is_part(text.substr(0, slash)) && is_part(text.substr(slash + 1));
}

void require_types(const std::string& port, std::string_view types)
{
    for (std::size_t begin = 0; begin <= types.size();) {
        const auto end = std::min(types.find(',', begin), types.size());
        const auto type = types.substr(begin, end - begin);
        if (!is_media_type(type))
            throw Error(Errc::invalid_argument, port + ": " + in_quotes(type) + " is not a media type",
                        "write TYPE/SUBTYPE, as in image/raw, and a list with commas and no spaces");
        begin = end + 1;
    }
}

[[noreturn]] void refuse_twice(const std::string& what)
{
    throw Error(Errc::invalid_argument, what + " is declared twice", "give each a name of its own");
}

}  // namespace

void require_input(const Interface& declared, const std::string& name, const std::string& types)
{
    const std::string port = "input " + require_port_name(name, "input");
    if (declared.input(name))
        refuse_twice(port);
    require_types(port, types);
}

void require_output(const Interface& declared, const std::string& name, const std::string& types)
{
    const std::string port = "output " + require_port_name(name, "output");
    if (declared.output(name))
        refuse_twice(port);
    require_types(port, types);
}

void require_parameter(const Interface& declared, const std::string& name)
{
    if (declared.parameter(name))
        refuse_twice("parameter " + require_name(name, "parameter"));
}

}  // namespace hive::c
