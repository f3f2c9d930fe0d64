// Numbers as people read them.
#pragma once

#include <hive/json.hpp>

#include <cstdint>
#include <string>

namespace hivectl {

/// "850 us", "12 ms", "3.4 s", "2 min 5 s", "3 h 12 min", "2 d 4 h".
std::string duration_text(std::int64_t microseconds);
/// One digit behind the point: "12.3".
std::string tenths_text(double number);
/// "1 event", "30 events".
std::string count_text(std::int64_t count, std::string_view noun);
/// "850 B", "12.3 kB", "1.5 GB".
std::string size_text(std::int64_t bytes);
/// Local time of day with milliseconds, the date before it when it is another day: "14:03:07.120".
std::string time_text(std::int64_t microseconds_since_1970);

// The same as formats of a column.
std::string as_duration(const hive::Json& microseconds);
std::string as_tenths(const hive::Json& number);
std::string as_percent(const hive::Json& number);
std::string as_time(const hive::Json& microseconds_since_1970);

}  // namespace hivectl
