// Formats durations, sizes, rates and times.
#include "words/format.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <utility>

namespace hivectl {
namespace {

std::tm local(std::time_t seconds)
{
    std::tm result{};
    localtime_r(&seconds, &result);
    return result;
}

using Units = std::array<std::pair<std::string_view, double>, 6>;

constexpr Units durations{{{"us", 1e-6}, {"ms", 1e-3}, {"s", 1}, {"min", 60}, {"h", 3600}, {"d", 86400}}};
constexpr Units sizes{{{"b", 1}, {"k", 1e3}, {"kb", 1e3}, {"mb", 1e6}, {"gb", 1e9}, {"tb", 1e12}}};

std::string in_lower_case(std::string_view text)
{
    std::string lower(text);
    std::ranges::transform(lower, lower.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return lower;
}

std::optional<double> measured(std::string_view text, std::string_view unit, const Units& units)
{
    const std::string word(text);
    char* end = nullptr;
    const double number = std::strtod(word.c_str(), &end);
    if (end == word.c_str() || !std::isfinite(number))
        return std::nullopt;
    while (*end == ' ')
        ++end;
    const auto written = in_lower_case(*end ? std::string_view(end) : unit);
    const auto found = std::ranges::find(units, std::string_view(written), [](const auto& row) { return row.first; });
    return found == units.end() ? std::nullopt : std::optional(number * found->second);
}

}  // namespace

std::optional<double> seconds_of(std::string_view text, std::string_view unit)
{
    return measured(text, unit, durations);
}

std::optional<double> bytes_of(std::string_view text, std::string_view unit) { return measured(text, unit, sizes); }

std::string tenths_text(double number)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", number);
    return text;
}

std::string count_text(std::int64_t count, std::string_view noun)
{
    return std::to_string(count) + " " + std::string(noun) + (count == 1 ? "" : "s");
}

std::string size_text(std::int64_t bytes)
{
    auto size = static_cast<double>(bytes);
    const char* unit = "B";
    for (const char* larger : {"kB", "MB", "GB", "TB"})
        if (size >= 999.95) {
            size /= 1000;
            unit = larger;
        }
    return (bytes < 1000 ? std::to_string(bytes) : tenths_text(size)) + " " + unit;
}

std::string time_text(std::int64_t microseconds_since_1970)
{
    const std::tm then = local(static_cast<std::time_t>(microseconds_since_1970 / 1'000'000));
    const std::tm today = local(std::time(nullptr));
    char text[32];
    const bool same_day = then.tm_year == today.tm_year && then.tm_yday == today.tm_yday;
    const auto length = std::strftime(text, sizeof text, same_day ? "%H:%M:%S" : "%F %H:%M:%S", &then);
    char milliseconds[8];
    std::snprintf(milliseconds, sizeof milliseconds, ".%03d", static_cast<int>(microseconds_since_1970 / 1000 % 1000));
    return std::string(text, length) + milliseconds;
}

std::string as_duration(const hive::Json& value)
{
    return value.is_number() ? duration_text(value.get<std::int64_t>()) : std::string();
}
std::string as_tenths(const hive::Json& value)
{
    return value.is_number() ? tenths_text(value.get<double>()) : std::string();
}

std::string as_time(const hive::Json& value)
{
    return value.is_number() ? time_text(value.get<std::int64_t>()) : std::string();
}

std::string as_size(const hive::Json& value)
{
    return value.is_number() ? size_text(value.get<std::int64_t>()) : std::string();
}

std::string as_percent(const hive::Json& value)
{
    return value.is_number() ? std::to_string(std::lround(value.get<double>())) + "%" : std::string();
}

}  // namespace hivectl
