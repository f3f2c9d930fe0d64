// Parses and prints key=value.
#include "words/settings.hpp"

#include "words/output.hpp"

#include <hive/error.hpp>
#include <hive/name.hpp>

namespace hivectl {

hive::Json parse_settings(const std::vector<std::string>& words)
{
    hive::Json settings = hive::Json::object();
    for (const auto& word : words) {
        const auto equals = word.find('=');
        if (equals == std::string::npos)
            throw hive::Error(hive::Errc::invalid_argument, hive::in_quotes(word) + " is not key=value",
                              "write for example " + printable(word) + "=1");
        const std::string key = hive::require_name(word.substr(0, equals), "parameter");
        if (settings.contains(key))
            throw hive::Error(hive::Errc::invalid_argument, key + " is given twice");
        settings[key] = word.substr(equals + 1);
    }
    return settings;
}

std::string settings_text(const hive::Json& values)
{
    if (values.size() == 1)
        return bare(values.begin().value()) + "\n";
    std::string text;
    for (const auto& [key, value] : values.items())
        text += bare(key) + "=" + bare(value) + "\n";
    return text;
}

std::string settings_text(const std::string& drone, const hive::Json& values)
{
    std::string text;
    for (const auto& [key, value] : values.items())
        text += drone + " " + bare(key) + "=" + bare(value) + "\n";
    return text;
}

}  // namespace hivectl
