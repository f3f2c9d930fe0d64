// Halts the sources, then looks again and again which drones are drained.
#include "ending.hpp"

#include "../directory.hpp"
#include "draining.hpp"

#include <hive/event/clock.hpp>

#include <algorithm>
#include <thread>

namespace hive::swarm {

using namespace std::chrono_literals;

namespace {

std::vector<std::string> without(const std::vector<StatusAnswer>& all, const std::vector<std::string>& some)
{
    std::vector<std::string> names;
    for (const auto& answer : all)
        if (std::ranges::find(some, answer.drone) == some.end())
            names.push_back(answer.drone);
    return names;
}

}  // namespace

SwarmOutcome Ending::run(std::chrono::milliseconds patience, const SwarmWatch& watch)
{
    const auto end = event::Clock::now() + patience;
    auto left = ask();
    const auto all = left.size();
    for (const auto& source : sources(left))
        try {
            application_.halt(source);
        } catch (const Error&) {
            // It is ended all the same.
        }
    for (; !left.empty(); left = ask()) {
        const bool late = event::Clock::now() >= end || (watch.cancelled && watch.cancelled());
        std::vector<std::string> names = drained(left);
        if (late) {
            names.clear();
            std::ranges::transform(left, std::back_inserter(names), &StatusAnswer::drone);
        }
        stop(names);
        if (watch.on_progress)
            watch.on_progress(all - left.size() + names.size(), all, "ended");
        if (watch.on_waiting)
            watch.on_waiting(without(left, names));
        if (late)
            break;
        if (names.empty())
            std::this_thread::sleep_for(10ms);
    }
    return std::move(outcome_);
}

/// Those that run. What has failed to end is not asked again.
std::vector<StatusAnswer> Ending::ask() const
{
    std::vector<std::string> names;
    for (const auto& drone : plan_.drones)
        if (std::ranges::none_of(outcome_.failures, [&](const auto& failure) { return failure.drone == drone.name; }))
            names.push_back(drone.name);
    auto answers = application_.status(names);
    std::erase_if(answers,
                  [](const StatusAnswer& answer) { return answer.error && answer.error->code() == Errc::not_found; });
    return answers;
}

void Ending::stop(const std::vector<std::string>& drones)
{
    for (const auto& answer : application_.stop(drones)) {
        if (answer.error && answer.error->code() != Errc::not_found)
            outcome_.failures.push_back({answer.drone, *answer.error});
        else
            outcome_.steps.push_back({.what = SwarmStep::What::stop, .drone = answer.drone});
    }
}

}  // namespace hive::swarm
