// Halts the sources, then polls for drained drones.
#include "ending.hpp"

#include "../directory.hpp"
#include "../engines/engine.hpp"
#include "../inquiry.hpp"
#include "present.hpp"
#include "draining.hpp"

#include <hive/event/clock.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace hive::swarm {

using namespace std::chrono_literals;

namespace {

constexpr auto engines_timeout = 2s;  ///< in addition to the drones' time to exit

std::vector<std::string> without(const std::vector<StatusAnswer>& all, const std::vector<std::string>& some)
{
    std::vector<std::string> names;
    for (const auto& answer : all)
        if (std::ranges::find(some, answer.drone) == some.end())
            names.push_back(answer.drone);
    return names;
}

}  // namespace

SwarmOutcome Ending::run(std::chrono::milliseconds timeout, const SwarmWatch& watch)
{
    const auto end = event::Clock::now() + timeout;
    forget_crashed();
    auto left = ask(watch);
    const auto all = left.size();
    for (const auto& source : sources(left))
        try {
            application_.halt(source);
        } catch (const Error&) {
            // Stop it anyway.
        }
    for (; !left.empty(); left = ask(watch)) {
        const bool late = event::Clock::now() >= end || (watch.cancelled && watch.cancelled());
        std::vector<std::string> names = drained(left);
        if (late) {
            names.clear();
            std::ranges::transform(left, std::back_inserter(names), &StatusAnswer::drone);
        }
        stop(names, end);
        if (watch.on_progress)
            watch.on_progress(all - left.size() + names.size(), all, "ended");
        if (watch.on_waiting)
            watch.on_waiting(without(left, names));
        if (late)
            break;
        if (names.empty())
            Inquiry(application_).wait(event::Clock::now() + 10ms, {});
    }
    return std::move(outcome_);
}

/// Saved state is only for drones that restart.
void Ending::forget_crashed()
{
    auto names = application_.remembered();
    for (const auto& failed : application_.failed())
        names.push_back(failed.drone);
    std::erase_if(names, [&](const std::string& name) { return !plan_.drone(name); });
    application_.stop(names, plan_.name);
}

/// The running drones, except those of other swarms and those that failed to stop.
std::vector<StatusAnswer> Ending::ask(const SwarmWatch& watch)
{
    std::vector<std::string> names;
    for (const auto& drone : plan_.drones)
        if (!left_alone_.contains(drone.name) && std::ranges::none_of(outcome_.failures, [&](const auto& failure) {
                return failure.drone == drone.name;
            }))
            names.push_back(drone.name);
    auto answers = application_.status(names);
    std::erase_if(answers, [&](const StatusAnswer& answer) {
        if (const auto* error = error_of(answer.status))
            return error->code() == Errc::not_found;
        if (owns(plan_, answer))
            return false;
        left_alone_.insert(answer.drone);
        if (watch.told)
            watch.told(answer.drone + " was " + owner_text(answer) + ", so it is left alone");
        return true;
    });
    return answers;
}

void Ending::stop(const std::vector<std::string>& drones, event::Clock::time_point end)
{
    std::vector<Answer> silent;
    for (const auto& answer : application_.stop(drones, plan_.name)) {
        if (const auto* error = error_of(answer.result); !error || error->code() == Errc::not_found)
            ended(answer.drone);
        else if (error->code() == Errc::refused)
            left_alone_.insert(answer.drone);  // it had not answered before
        else if (is_elsewhere(answer.drone))
            silent.push_back(answer);
        else
            outcome_.failures.push_back({answer.drone, *error});
    }
    if (!silent.empty())
        stop_silent(silent, end);
}

/// A drone of another machine that does not answer may be gone, hang, or be disconnected. Its engine can find out and
/// stop it.
void Ending::stop_silent(const std::vector<Answer>& silent, event::Clock::time_point end)
{
    std::map<std::string, std::unique_ptr<Engine>> engines;
    std::map<Engine*, std::vector<std::string>> by_engine;
    std::set<std::string> left;
    for (const auto& [drone, result] : silent) {
        const auto& host = plan_.drone(drone)->host;
        auto& engine = engines[host];
        if (!engine)
            engine = make_engine(plan_.engine_of(host), host, application_.home());
        engine->adopt({drone});
        by_engine[engine.get()].push_back(drone);
    }
    for (auto& failure : stop_all(by_engine, std::max(end, event::Clock::now()) + engines_timeout)) {
        left.insert(failure.drone);
        outcome_.failures.push_back(std::move(failure));
    }
    for (const auto& answer : silent)
        if (!left.contains(answer.drone)) {
            application_.forget_place(application_.place(answer.drone));
            ended(answer.drone);
        }
}

bool Ending::is_elsewhere(const std::string& drone) const
try {
    return !is_here(application_.place(drone)) && plan_.drone(drone)->host != Place::here;
} catch (const Error&) {
    return false;  // the name is no longer known
}

void Ending::ended(const std::string& drone)
{
    outcome_.steps.push_back({.what = SwarmStep::What::stop, .drone = drone});
}

}  // namespace hive::swarm
