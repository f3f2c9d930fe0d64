// Objects and lists of objects as blocks, everything else on one line.
#include "yaml.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace hive {
namespace {

bool is_block(const OrderedJson& value)
{
    if (value.is_object())
        return !value.empty();
    return value.is_array() && std::ranges::any_of(value, [](const auto& item) { return item.is_structured(); });
}

std::string yaml_line(const OrderedJson& value)
{
    return value.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

/// Unquoted only if every reader takes it for a text: not 1, on, no or null.
std::string yaml_key(const std::string& key)
{
    static const std::set<std::string> of_other_types{"y", "n", "yes", "no", "on", "off", "true", "false", "null"};
    const auto fits = [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.' || c == '/';
    };
    std::string lower = key;
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
    const bool plain = !key.empty() && std::isalpha(static_cast<unsigned char>(key[0])) != 0
                       && std::ranges::all_of(key, fits) && !of_other_types.contains(lower);
    return plain ? key : yaml_line(key);
}

}  // namespace

std::string yaml_text(const OrderedJson& object, std::size_t indent)
{
    const std::string space(indent, ' ');
    std::string text;
    if (object.is_array()) {
        for (const auto& item : object) {
            auto block =
                is_block(item) ? yaml_text(item, indent + 2) : std::string(indent + 2, ' ') + yaml_line(item) + "\n";
            block[indent] = '-';  // the first line begins with two spaces more than it needs
            text += block;
        }
        return text;
    }
    for (const auto& [key, value] : object.items())
        text += space + yaml_key(key) + ":"
                + (is_block(value) ? "\n" + yaml_text(value, indent + 2) : " " + yaml_line(value) + "\n");
    return text;
}

}  // namespace hive
