// What fell is known by what it left: a state in the home, or a place in the list.
#include "staying.hpp"

#include "../directory.hpp"
#include "changes.hpp"
#include "claim.hpp"
#include "differences.hpp"
#include "failed_drones.hpp"
#include "record.hpp"
#include "starting.hpp"

#include <hive/event/home.hpp>
#include <hive/process.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace hive::swarm {

using namespace std::chrono_literals;

namespace {

bool is_elsewhere(const Place& place) { return !place.address.empty() && !is_here(place); }

/// Not when it was taken down, nor when a `down` could not end it.
bool is_up(const SwarmPlan& brought_up, const std::string& drone)
{
    const auto* const found = brought_up.drone(drone);
    return found && found->restart != Restart::never;
}

}  // namespace

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
    if (fallen().empty())
        return;
    Texts news;
    if (const auto alone = claim_if_free(application_.home(), plan_.name))
        news = start_what_fell(watch);
    for (const auto& text : news)
        told_(text);
}

/// With the claim: whoever had it until now may have started or ended what seemed to have fallen.
Staying::Texts Staying::start_what_fell(const SwarmWatch& watch)
{
    const auto brought_up = Record(application_.home(), plan_.name).read();
    std::vector<std::string> again;
    Texts news;
    for (const auto& drone : fallen())
        if (!is_up(brought_up, drone)) {
            if (taken_down_.insert(drone).second)
                news.push_back(drone + " was taken down, so it is not started again before it is brought up");
        } else if (put_off_.contains(drone) || limits_[drone].allows(Clock::now())) {
            again.push_back(drone);
        } else {
            give_up(drone);
            news.push_back(drone + " has fallen " + std::to_string(RestartLimit::most + 1) + " times within "
                           + std::to_string(RestartLimit::within / 1s)
                           + " s, so it is not started again; see why: hivectl logs " + drone);
        }
    if (!again.empty())
        std::ranges::move(start(again, watch), std::back_inserter(news));
    return news;
}

/// Whoever was stopped by a command has left nothing, and is to stay so unless the file says `always`.
std::vector<std::string> Staying::fallen()
{
    std::vector<std::string> names, gone;
    for (const auto& drone : plan_.drones)
        if (drone.restart != Restart::never && !given_up_.contains(drone.name))
            names.push_back(drone.name);
    const auto answers = application_.status(names);
    const auto remembered = application_.remembered();
    for (const auto& answer : answers) {
        if (!answer.error || answer.error->code() == Errc::timeout) {
            missing_since_.erase(answer.drone);
            put_off_.erase(answer.drone);
            taken_down_.erase(answer.drone);
            if (!answer.error && owns(plan_, answer))
                shared_.erase(answer.drone);
            else if (!answer.error)
                shared_.insert(answer.drone);
            continue;
        }
        if (shared_.contains(answer.drone) || may_be_ending(answer))
            continue;
        const bool crashed = is_elsewhere(answer.place) || put_off_.contains(answer.drone)
                             || std::ranges::find(remembered, answer.drone) != remembered.end();
        if (crashed || plan_.drone(answer.drone)->restart == Restart::always)
            gone.push_back(answer.drone);
    }
    return gone;
}

/// Here it has its name until it has ended. Elsewhere whoever ends it forgets its place, but only when it is gone.
bool Staying::may_be_ending(const StatusAnswer& answer)
{
    if (!is_elsewhere(answer.place))
        return event::Home(application_.home()).alive(answer.drone);
    const auto now = Clock::now();
    return now - missing_since_.try_emplace(answer.drone, now).first->second < 1s;
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

Staying::Texts Staying::start(const std::vector<std::string>& drones, const SwarmWatch& watch)
{
    for (const auto& drone : drones) {
        missing_since_.erase(drone);
        put_off_.erase(drone);
        unsettled_.insert(drone);
    }
    settle_at_ = {};
    bool wanted = false;  // once: whoever wanted the claim may have gone again meanwhile
    const SwarmWatch until_wanted{.on_progress = watch.on_progress, .cancelled = [&] {
                                      wanted = wanted || claim_is_wanted(application_.home(), plan_.name);
                                      return wanted || (watch.cancelled && watch.cancelled());
                                  }};
    Starting starting(application_, plan_);
    auto failures = starting.run(drones, 60s, until_wanted, Starting::AtFailure::go_on);
    if (wanted)
        failures = give_way(starting, std::move(failures));
    Texts news;
    for (const auto& drone : drones) {
        const auto failure = std::ranges::find(failures, drone, &SwarmFailure::drone);
        news.push_back(
            drone
            + (failure == failures.end() ? " had fallen and runs again" : ": " + std::string(failure->error.what()))
            + " (" + std::to_string(limits_[drone].counted()) + " of " + std::to_string(RestartLimit::most)
            + " times)");
    }
    return news;
}

/// What is not ready is ended, so that whoever changes the swarm next meets none that comes up behind its back.
std::vector<SwarmFailure> Staying::give_way(Starting& starting, std::vector<SwarmFailure> failures)
{
    std::set<std::string> not_ready;
    for (auto& [drone, error] : failures)
        if (error.code() == Errc::stopped && plan_.drone(drone)) {  // else all were ready, and this is the swarm
            not_ready.insert(drone);
            error = Error(Errc::stopped, "not started now, because somebody else is changing the swarm");
        }
    put_off_.insert(not_ready.begin(), not_ready.end());
    auto told = starting.undo(not_ready);
    std::ranges::move(failures, std::back_inserter(told));
    return told;
}

void Staying::settle()
{
    Texts troubles;
    if (const auto alone = claim_if_free(application_.home(), plan_.name))
        troubles = settle_alone();
    for (const auto& trouble : troubles)
        tell_trouble(trouble);
}

/// With the claim, unless somebody waits for that: the rest has its turn later.
Staying::Texts Staying::settle_alone()
{
    const auto brought_up = Record(application_.home(), plan_.name).read();
    std::erase_if(unsettled_, [&](const std::string& drone) { return !is_up(brought_up, drone); });
    settle_at_ = Clock::now() + 1s;
    Changes changes(application_);
    std::set<std::string> unsettled;
    Texts troubles;
    for (const auto& step : differences(application_, plan_, plan_).steps) {
        if ((step.what != SwarmStep::What::set && step.what != SwarmStep::What::connect)
            || !unsettled_.contains(step.drone))
            continue;
        if (claim_is_wanted(application_.home(), plan_.name))
            return troubles;
        try {
            changes.make(step);
        } catch (const Error& error) {
            unsettled.insert(step.drone);
            troubles.push_back(step.drone + ": " + error.what());
        }
    }
    unsettled_ = std::move(unsettled);
    return troubles;
}

void Staying::tell_trouble(const std::string& text)
{
    if (std::exchange(trouble_, text) != text)
        told_(text);
}

}  // namespace hive::swarm
