// Stops all drones, then starts all.
#include "restarting.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace hive::swarm {

using namespace std::chrono_literals;

Restarting::Restarting(Application& application, const Differences& differences)
    : application_(application),
      differences_(differences),
      now_(application, differences.wanted),
      before_(application, differences.ran)
{
    std::ranges::transform(differences.ran.drones, std::back_inserter(drones_), &SwarmDrone::name);
}

std::vector<SwarmFailure> Restarting::run(std::chrono::milliseconds timeout, const SwarmWatch& watch)
{
    if (drones_.empty())
        return {};
    begun_ = true;
    auto failures = failures_in(application_.stop(drones_));
    if (failures.empty())
        failures = now_.run(drones_, timeout, watch);
    return failures.empty() ? connect(differences_.kept) : failures;
}

std::vector<SwarmFailure> Restarting::undo()
{
    if (!std::exchange(begun_, false))
        return {};
    auto remains = now_.undo();
    std::vector<std::string> gone;
    for (const auto& answer : application_.status(drones_))
        if (answer.error && answer.error->code() == Errc::not_found)
            gone.push_back(answer.drone);
    std::ranges::move(before_.run(gone, 60s, {}), std::back_inserter(remains));
    std::ranges::move(connect(differences_.ran.connections), std::back_inserter(remains));
    return remains;
}

std::vector<SwarmFailure> Restarting::connect(const std::vector<SwarmConnection>& connections)
{
    std::vector<SwarmFailure> failures;
    for (const auto& made : application_.connect(connections))
        if (made.error)
            failures.push_back({made.receiver.drone, *made.error});
    return failures;
}

std::vector<SwarmFailure> failures_in(const std::vector<Answer>& answers)
{
    std::vector<SwarmFailure> failures;
    for (const auto& answer : answers)
        if (answer.error && answer.error->code() != Errc::not_found)
            failures.push_back({answer.drone, *answer.error});
    return failures;
}

}  // namespace hive::swarm
