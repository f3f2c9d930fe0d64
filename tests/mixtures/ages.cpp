// Times of a status beside the age of the history.
#include "limits.hpp"

namespace hive::mixtures {

Problems impossible_ages(const Statuses& statuses, std::chrono::microseconds age,
                         std::optional<std::chrono::microseconds> error)
{
    Problems problems;
    const auto within = [&](std::int64_t time, std::int64_t limit, const std::string& what, std::int64_t beyond = 0) {
        if (time < -beyond || time > limit + beyond)
            problems.push_back("ages: " + what + " is " + std::to_string(time) + " us, and at most "
                               + std::to_string(limit) + " us is possible");
    };
    for (const auto& [name, status] : statuses) {
        within(status.uptime_us, age.count(), "the uptime of " + name);
        within(status.busy_us, status.uptime_us, "the time that " + name + " was busy");
        within(status.busy_for_us, status.busy_us, "the time of the present callback of " + name);
        for (const auto& input : error ? status.inputs : std::vector<InputStatus>{})
            within(input.last_age_us, age.count(), "the age of the last event of " + input.from + " -> " + name,
                   error->count());
    }
    return problems;
}

}  // namespace hive::mixtures
