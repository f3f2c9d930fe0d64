// Asking many drones at once.
#include "status_of.hpp"

namespace hive::mixtures {

Statuses statuses_of(Application& application, const std::vector<std::string>& drones)
{
    Statuses statuses;
    for (auto& answer : application.status(drones))
        if (!answer.error)
            statuses.emplace(answer.drone, std::move(answer.status));
    return statuses;
}

}  // namespace hive::mixtures
