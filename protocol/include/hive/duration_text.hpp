// Durations as readable text.
#pragma once

#include <cstdint>
#include <string>

namespace hive {

/// "850 us", "12 ms", "3.4 s", "2 min 5 s", "3 h 12 min", "2 d 4 h".
std::string duration_text(std::int64_t microseconds);

}  // namespace hive
