// Describes the newest image as JSON.
#include "status.hpp"

#include <cmath>

namespace view {

nlohmann::json status_of(const Exchange::Newest& newest, std::size_t browsers, Exchange::Time now,
                         std::chrono::system_clock::time_point wall)
{
    using std::chrono::duration_cast, std::chrono::milliseconds;
    const Origin& origin = newest.image->origin();
    nlohmann::json status{
        {"sender", nullptr},   {"source", nullptr},   {"sequence", nullptr}, {"number", newest.number},
        {"width", nullptr},    {"height", nullptr},   {"rate", 0},           {"age_ms", nullptr},
        {"since_ms", nullptr}, {"browsers", browsers}};
    if (newest.number == 0)
        return status;
    const auto since = duration_cast<milliseconds>(now - newest.since).count();
    status.update({{"sender", origin.sender},
                   {"source", origin.source},
                   {"sequence", origin.sequence},
                   {"width", origin.size.width},
                   {"height", origin.size.height},
                   {"rate", newest.going_on(now) ? std::round(origin.rate * 10) / 10 : 0},
                   {"since_ms", since}});
    if (origin.captured)
        status["age_ms"] = std::max<std::int64_t>(0, duration_cast<milliseconds>(wall - *origin.captured).count());
    return status;
}

}  // namespace view
