// What fell is known by what it left: a state in the home, or a place in the list.
#include "staying.hpp"

#include "../directory.hpp"
#include "changes.hpp"
#include "differences.hpp"
#include "failed_drones.hpp"
#include "starting.hpp"

#include <hive/process.hpp>

#include <algorithm>
#include <utility>

namespace hive::swarm {

using namespace std::chrono_literals;

bool RestartLimit::allows(Clock::time_point now)
{
    while (!times_.empty() && now - times_.front() > within)
        times_.pop_front();
    if (times_.size() >= most)
        return false;
    times_.push_back(now);
    return true;
}

void Staying::look(const SwarmWatch& watch)
try {
    look_after_the_fallen(watch);
    if (!unsettled_.empty() && Clock::now() >= settle_at_)
        settle();
} catch (const Error& error) {
    tell_trouble(error.what());
}

void Staying::look_after_the_fallen(const SwarmWatch& watch)
{
    reap_background_processes();
    std::vector<std::string> again;
    for (const auto& drone : fallen())
        if (limits_[drone].allows(Clock::now())) {
            again.push_back(drone);
        } else {
            give_up(drone);
            told_(drone + " has fallen " + std::to_string(RestartLimit::most + 1) + " times within "
                  + std::to_string(RestartLimit::within / 1s) + " s, so it is not started again; see why: hivectl logs "
                  + drone);
        }
    if (!again.empty())
        start(again, watch);
}

/// Whoever was stopped by a command has left nothing, and is to stay so unless the file says `always`.
std::vector<std::string> Staying::fallen() const
{
    const auto remembered = application_.remembered();
    std::vector<std::string> names, gone;
    for (const auto& drone : plan_.drones)
        if (drone.restart != Restart::never && !given_up_.contains(drone.name))
            names.push_back(drone.name);
    for (const auto& answer : application_.status(names)) {
        if (!answer.error || answer.error->code() == Errc::timeout)
            continue;
        const bool listed = !answer.place.address.empty() && !is_here(answer.place);
        const bool crashed = listed || std::ranges::find(remembered, answer.drone) != remembered.end();
        if (crashed || plan_.drone(answer.drone)->restart == Restart::always)
            gone.push_back(answer.drone);
    }
    return gone;
}

void Staying::give_up(const std::string& drone)
{
    given_up_.insert(drone);
    FailedDrones(application_.home())
        .add({.drone = drone,
              .reason = "fell " + std::to_string(RestartLimit::most + 1) + " times within "
                        + std::to_string(RestartLimit::within / 1s) + " s",
              .log = {}});
}

void Staying::start(const std::vector<std::string>& drones, const SwarmWatch& watch)
{
    unsettled_.insert(drones.begin(), drones.end());
    settle_at_ = {};
    Starting starting(application_, plan_);
    const auto failures = starting.run(drones, 60s, watch, Starting::AtFailure::go_on);
    for (const auto& drone : drones) {
        const auto failure = std::ranges::find(failures, drone, &SwarmFailure::drone);
        told_(drone
              + (failure == failures.end() ? " had fallen and runs again" : ": " + std::string(failure->error.what()))
              + " (" + std::to_string(limits_[drone].counted()) + " of " + std::to_string(RestartLimit::most)
              + " times)");
    }
}

void Staying::settle()
{
    settle_at_ = Clock::now() + 1s;
    Changes changes(application_);
    std::set<std::string> unsettled;
    for (const auto& step : differences(application_, plan_, plan_)) {
        if ((step.what != SwarmStep::What::set && step.what != SwarmStep::What::connect)
            || !unsettled_.contains(step.drone))
            continue;
        try {
            changes.make(step);
        } catch (const Error& error) {
            unsettled.insert(step.drone);
            tell_trouble(step.drone + ": " + error.what());
        }
    }
    unsettled_ = std::move(unsettled);
}

void Staying::tell_trouble(const std::string& text)
{
    if (std::exchange(trouble_, text) != text)
        told_(text);
}

}  // namespace hive::swarm
