// One loop polls the engines and queries the drones.
#include "starting.hpp"

#include "../directory.hpp"
#include "present.hpp"

#include <hive/event/clock.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace hive::swarm {

using namespace std::chrono_literals;

namespace {

/// A released lock or a taken name is not signalled, so it is polled.
constexpr auto look_every = 10ms;
constexpr auto answer_timeout = 2s;

}  // namespace

Starting::Starting(Application& application, const SwarmPlan& plan)
    : application_(application), plan_(plan), inquiry_(application)
{
}

std::vector<SwarmFailure> Starting::run(const std::vector<std::string>& drones, std::chrono::milliseconds timeout,
                                        const SwarmWatch& watch)
{
    begin(drones, timeout);
    std::vector<SwarmFailure> failures;
    while (!waiting_.empty() && failures.empty()) {
        failures = poll(watch);
        if (watch.on_progress)
            watch.on_progress(drones.size() - waiting_.size(), drones.size(), "started");
        if (watch.on_waiting)
            watch.on_waiting({waiting_.begin(), waiting_.end()});
        if (watch.cancelled && watch.cancelled()) {
            failures.push_back(
                {waiting_.empty() ? plan_.name : *waiting_.begin(), Error(Errc::stopped, "interrupted")});
            break;
        }
        if (!waiting_.empty())
            wait();
    }
    return failures;
}

std::vector<SwarmFailure> Starting::poll(const SwarmWatch& watch)
{
    hear_engines();
    look_who_is_ready(watch);
    if (event::Clock::now() >= end_)
        for (const auto& drone : std::set(waiting_))
            failed(drone, not_ready_in_time(drone));
    return std::exchange(failures_, {});
}

void Starting::wait()
{
    std::vector<int> descriptors;
    for (const auto& [host, engine] : engines_)
        std::ranges::copy(engine->descriptors(), std::back_inserter(descriptors));
    inquiry_.wait(std::min(end_, event::Clock::now() + look_every), descriptors);
}

Error Starting::not_ready_in_time(const std::string& drone) const
{
    const auto last = last_errors_.find(drone);
    if (last == last_errors_.end())
        return {Errc::timeout, drone + " was not ready in time", "allow more: --timeout SECONDS"};
    return {Errc::timeout, drone + " was not ready in time: " + last->second.what(), last->second.advice()};
}

std::vector<SwarmFailure> Starting::undo(event::Clock::time_point until)
{
    const auto drones = std::exchange(begun_, {});
    std::map<Engine*, std::vector<std::string>> by_engine;
    for (const auto& drone : drones)
        by_engine[&engine_of(*plan_.drone(drone))].push_back(drone);
    auto remains = stop_all(by_engine, until);
    auto ended = drones;
    for (const auto& failure : remains)
        ended.erase(failure.drone);
    forget_places(ended);
    return remains;
}

void Starting::forget_places(const std::set<std::string>& drones)
{
    for (const auto& drone : drones)
        if (const auto found = places_.find(drone); found != places_.end())
            application_.forget_place(found->second);
}

Engine& Starting::engine_of(const SwarmDrone& drone)
{
    auto& engine = engines_[drone.host];
    if (!engine)
        engine = make_engine(plan_.engine_of(drone.host), drone.host, application_.home());
    return *engine;
}

void Starting::begin(const std::vector<std::string>& drones, std::chrono::milliseconds timeout)
{
    end_ = event::Clock::now() + timeout;
    std::map<Engine*, std::vector<SwarmDrone>> by_engine;
    for (const auto& name : drones)
        by_engine[&engine_of(*plan_.drone(name))].push_back(as_started(plan_, *plan_.drone(name)));
    begun_ = {drones.begin(), drones.end()};
    waiting_ = begun_;
    for (auto& [engine, orders] : by_engine)
        engine->begin(std::move(orders), end_);
}

void Starting::hear_engines()
{
    std::vector<Place> places;
    for (auto& [host, engine] : engines_)
        for (const auto& [drone, report] : engine->poll()) {
            const auto* error = error_of(report);
            if (error && error->code() != Errc::name_taken) {  // else an earlier, killed hivectl had started it
                failed(drone, *error);
                continue;
            }
            placed_.insert(drone);
            const auto* started = std::get_if<Started>(&report);
            if (started && !is_here(started->place)) {
                places.push_back(started->place);
                if (!started->found)
                    places_[drone] = started->place;
            }
        }
    application_.replace_places(places);
}

void Starting::look_who_is_ready(const SwarmWatch& watch)
{
    inquiry_.ask({placed_.begin(), placed_.end()}, answer_timeout);
    for (const auto& answer : inquiry_.take())
        if (placed_.contains(answer.drone))
            try {
                hear(answer, watch);
            } catch (const Error& error) {
                failed(answer.drone, error);
            }
}

void Starting::hear(const StatusAnswer& answer, const SwarmWatch& watch)
{
    const auto& drone = *plan_.drone(answer.drone);
    const auto* error = error_of(answer.status);
    if (error && error->code() == Errc::not_permitted)
        throw engine_of(drone).explained(*error);  // a wrong key does not become right by waiting
    if (error) {
        last_errors_.insert_or_assign(drone.name, *error);
        return engine_of(drone).look_again(drone.name, *error);
    }
    last_errors_.erase(drone.name);
    if (std::get<Status>(answer.status).state == State::starting)
        return;
    require_same(plan_, drone, answer);  // another process may have been faster
    if (watch.told && !owns(plan_, answer))
        watch.told(drone.name + " runs already, " + owner_text(answer) + ", and is used as it is");
    placed_.erase(drone.name);
    waiting_.erase(drone.name);
}

void Starting::failed(std::string drone, const Error& error)
{
    placed_.erase(drone);
    if (waiting_.erase(drone) == 0)
        return;  // already ready or failed
    failures_.push_back({std::move(drone), error});
}

}  // namespace hive::swarm
