// Stops all drones, then starts all.
#include "restarting.hpp"

#include <hive/event/clock.hpp>
#include <hive/event/home.hpp>

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
    for (const auto& step : differences.steps)
        if (step.what == SwarmStep::What::restart)
            (step.values.contains("on") ? moved_ : back_).push_back(step.drone);
}

std::vector<SwarmFailure> Restarting::run(std::chrono::milliseconds timeout, const SwarmWatch& watch)
{
    if (drones_.empty())
        return {};
    begun_ = true;
    auto failures = stop();
    if (failures.empty())
        failures = now_.run(drones_, timeout, watch);
    return failures.empty() ? connect(differences_.kept) : failures;
}

/// What waits for a drone that comes back loses nothing meanwhile. A drone that moves leaves no state behind on its
/// machine.
std::vector<SwarmFailure> Restarting::stop()
{
    for (const auto& connection : differences_.ran.connections)
        if (std::ranges::none_of(differences_.kept,
                                 [&](const SwarmConnection& kept) { return same_ends(kept, connection); }))
            disconnect(connection);
    auto failures = failures_in(application_.stop_to_restart(back_));
    std::ranges::move(failures_in(application_.stop(moved_)), std::back_inserter(failures));
    return failures;
}

void Restarting::disconnect(const SwarmConnection& connection)
try {
    application_.disconnect(connection.from, connection.to);
} catch (const Error& error) {
    if (error.code() != Errc::not_found)
        throw;
}

/// The processes that follow them lose nothing either. A process that does not answer yet has taken nothing over. It is
/// asked again for 2 s, or for 200 ms while it does not hold its name, since it may have crashed.
void Restarting::stop_new_processes()
{
    const event::Home home(application_.home());
    const auto begin = event::Clock::now();
    auto asked = back_;
    std::erase_if(asked, [&](const std::string& drone) { return !now_.begun().contains(drone); });
    while (!asked.empty()) {
        std::vector<std::string> reached;
        for (const auto& answer : application_.status(asked))
            if (value_of(answer.status))
                reached.push_back(answer.drone);
        application_.stop_to_restart(reached);
        std::erase_if(asked, [&](const std::string& drone) {
            const auto waited = event::Clock::now() - begin;
            return std::ranges::find(reached, drone) != reached.end() || waited >= (home.alive(drone) ? 2s : 200ms);
        });
        if (!asked.empty())
            now_.wait();
    }
}

std::vector<SwarmFailure> Restarting::undo()
{
    if (!std::exchange(begun_, false))
        return {};
    stop_new_processes();
    auto remains = now_.undo();
    std::vector<std::string> gone;
    for (const auto& answer : application_.status(drones_))
        if (const auto* error = error_of(answer.status); error && error->code() == Errc::not_found)
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
        if (const auto* error = error_of(answer.result); error && error->code() != Errc::not_found)
            failures.push_back({answer.drone, *error});
    return failures;
}

}  // namespace hive::swarm
