#include <hive/duration_text.hpp>

#include <algorithm>
#include <limits>

namespace hive {
namespace {

std::string in_two_units(std::int64_t value, std::int64_t big, const char* big_unit, const char* small_unit)
{
    const std::string first = std::to_string(value / big) + " " + big_unit;
    return value % big == 0 ? first : first + " " + std::to_string(value % big) + " " + small_unit;
}

}  // namespace

std::string duration_text(std::int64_t microseconds)
{
    if (microseconds < 0)  // the minimum has no positive counterpart
        return "-" + duration_text(-std::max(microseconds, -std::numeric_limits<std::int64_t>::max()));
    if (microseconds < 1000)
        return std::to_string(microseconds) + " us";
    if (microseconds < 1'000'000)
        return std::to_string(microseconds / 1000) + " ms";
    const std::int64_t seconds = microseconds / 1'000'000;
    if (seconds < 60)
        return std::to_string(seconds) + "." + std::to_string(microseconds / 100'000 % 10) + " s";
    if (seconds < 3600)
        return in_two_units(seconds, 60, "min", "s");
    if (seconds < 86400)
        return in_two_units(seconds / 60, 60, "h", "min");
    return in_two_units(seconds / 3600, 24, "d", "h");
}

}  // namespace hive
