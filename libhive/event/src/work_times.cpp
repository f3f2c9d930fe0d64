#include <hive/event/work_times.hpp>

#include <algorithm>

namespace hive::event {
namespace {

constexpr auto unknown_lease = std::chrono::seconds(30);
constexpr auto least_lease = std::chrono::seconds(2);
constexpr std::size_t times_needed = 3;

}  // namespace

Clock::duration WorkTimes::lease() const
{
    if (count_ < times_needed)
        return unknown_lease;
    return std::max<Clock::duration>(least_lease, 4 * *std::ranges::max_element(recent_));
}

}  // namespace hive::event
