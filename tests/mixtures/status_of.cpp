// Asking many drones at once.
#include "status_of.hpp"

namespace hive::mixtures {

Statuses statuses_of(Application& application, const std::vector<std::string>& drones)
{
    Statuses statuses;
    for (auto& answer : application.status(drones))
        if (auto* status = std::get_if<Status>(&answer.status))
            statuses.emplace(answer.drone, std::move(*status));
    return statuses;
}

}  // namespace hive::mixtures
