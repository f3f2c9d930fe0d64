// Numbers as people read them.
#pragma once

#include <hive/duration_text.hpp>
#include <hive/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hivectl {

using hive::duration_text;
/// One digit behind the point: "12.3".
std::string tenths_text(double number);
/// "1 event", "30 events".
std::string count_text(std::int64_t count, std::string_view noun);
/// "850 B", "12.3 kB", "1.5 GB".
std::string size_text(std::int64_t bytes);
/// What a person writes as a duration, in seconds: "5", "500ms", "2min"; nothing if it is not one.
/// @param unit  of a number alone: "s"
std::optional<double> seconds_of(std::string_view text, std::string_view unit = "s");
/// What a person writes as a size, in bytes: "200MB", "2 GB"; nothing if it is not one.
/// @param unit  of a number alone: "MB"
std::optional<double> bytes_of(std::string_view text, std::string_view unit);
/// Local time of day with milliseconds, the date before it when it is another day: "14:03:07.120".
std::string time_text(std::int64_t microseconds_since_1970);

// The same as formats of a column.
std::string as_duration(const hive::Json& microseconds);
std::string as_tenths(const hive::Json& number);
std::string as_percent(const hive::Json& number);
std::string as_size(const hive::Json& bytes);
std::string as_time(const hive::Json& microseconds_since_1970);

}  // namespace hivectl
