// Formats numbers for people.
#pragma once

#include <hive/duration_text.hpp>
#include <hive/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hivectl {

using hive::duration_text;
/// One digit after the point: "12.3".
std::string tenths_text(double number);
/// "1 event", "30 events".
std::string count_text(std::int64_t count, std::string_view noun);
/// "850 B", "12.3 kB", "1.5 GB".
std::string size_text(std::int64_t bytes);
/// Parses a duration, into seconds: "5", "500ms", "2min"; nothing if it is invalid.
/// @param unit  for a number without one: "s"
std::optional<double> seconds_of(std::string_view text, std::string_view unit = "s");
/// Parses a size, into bytes: "200MB", "2 GB"; nothing if it is invalid.
/// @param unit  for a number without one: "MB"
std::optional<double> bytes_of(std::string_view text, std::string_view unit);
/// Local time of day with milliseconds, with the date if it is another day: "14:03:07.120".
std::string time_text(std::int64_t microseconds_since_1970);

// The same as column formats.
std::string as_duration(const hive::Json& microseconds);
std::string as_tenths(const hive::Json& number);
std::string as_percent(const hive::Json& number);
std::string as_size(const hive::Json& bytes);
std::string as_time(const hive::Json& microseconds_since_1970);

}  // namespace hivectl
