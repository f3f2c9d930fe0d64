// One loop hears the engines and asks the drones.
#include "starting.hpp"

#include "../directory.hpp"
#include "differences.hpp"

#include <hive/event/clock.hpp>

#include <algorithm>
#include <iterator>
#include <thread>

namespace hive::swarm {

using namespace std::chrono_literals;

Starting::Starting(Application& application, const SwarmPlan& plan) : application_(application), plan_(plan) {}

std::vector<SwarmFailure> Starting::run(const std::vector<std::string>& drones, std::chrono::milliseconds patience,
                                        const SwarmWatch& watch, AtFailure at_failure)
{
    const auto end = event::Clock::now() + patience;
    begin(drones);
    while (!waiting_.empty() && (failures_.empty() || at_failure == AtFailure::go_on)) {
        hear_engines();
        look_who_is_ready();
        if (watch.on_progress)
            watch.on_progress(drones.size() - waiting_.size(), drones.size(), "started");
        if (watch.on_waiting)
            watch.on_waiting({waiting_.begin(), waiting_.end()});
        if (watch.cancelled && watch.cancelled())
            failed(waiting_.empty() ? plan_.name : *waiting_.begin(), Error(Errc::stopped, "interrupted"));
        else if (event::Clock::now() >= end)
            for (const auto& drone : std::set(waiting_))
                failed(drone, Error(Errc::timeout, drone + " was not ready in time", "allow more: --timeout SECONDS"));
        else
            std::this_thread::sleep_for(10ms);
    }
    return std::exchange(failures_, {});
}

std::vector<SwarmFailure> Starting::undo(const std::set<std::string>& drones)
{
    std::vector<SwarmFailure> remains;
    std::map<Engine*, std::vector<std::string>> by_engine;
    for (const auto& drone : drones)
        by_engine[&engine_of(*plan_.drone(drone))].push_back(drone);
    for (const auto& [engine, begun] : by_engine)
        try {
            std::ranges::move(engine->stop(begun), std::back_inserter(remains));
        } catch (const Error& error) {  // the other engines end theirs all the same
            for (const auto& drone : begun)
                remains.push_back({drone, error});
        }
    auto ended = drones;
    for (const auto& failure : remains)
        ended.erase(failure.drone);
    forget_places(ended);
    return remains;
}

/// But of those that answer: an engine leaves alone what it has found and not begun.
void Starting::forget_places(const std::set<std::string>& drones)
try {
    std::vector<Place> elsewhere;
    for (const auto& [drone, place] : places_)
        if (drones.contains(drone))
            elsewhere.push_back(place);
    std::vector<std::string> names;
    std::ranges::transform(elsewhere, std::back_inserter(names), &Place::drone);
    const auto answers = application_.status(names);
    for (std::size_t i = 0; i < elsewhere.size(); ++i)
        if (answers[i].error)
            application_.forget_place(elsewhere[i]);
} catch (const Error&) {
    // Cancelled once more: they stay in the list, as unreachable.
}

Engine& Starting::engine_of(const SwarmDrone& drone)
{
    auto& engine = engines_[drone.host];
    if (!engine)
        engine = make_engine(plan_.engine_of(drone.host), drone.host, application_.home());
    return *engine;
}

void Starting::begin(const std::vector<std::string>& drones)
{
    std::map<Engine*, std::vector<SwarmDrone>> by_engine;
    for (const auto& name : drones)
        by_engine[&engine_of(*plan_.drone(name))].push_back(as_started(plan_, *plan_.drone(name)));
    begun_ = {drones.begin(), drones.end()};
    waiting_ = begun_;
    for (auto& [engine, orders] : by_engine)
        engine->begin(std::move(orders));
}

void Starting::hear_engines()
{
    std::vector<Place> places;
    for (auto& [host, engine] : engines_)
        for (auto& report : engine->poll())
            if (!report.error) {
                if (!is_here(report.place)) {
                    places.push_back(report.place);
                    places_[report.drone] = report.place;
                }
                placed_.insert(report.drone);
            } else if (report.error->code() == Errc::name_taken) {
                placed_.insert(report.drone);  // an earlier hivectl that was killed had begun it
            } else {
                failed(report.drone, *report.error);
            }
    application_.replace_places(places);
}

void Starting::look_who_is_ready()
{
    const auto names = std::vector(placed_.begin(), placed_.end());
    for (const auto& answer : application_.status(names))
        try {
            if (answer.error) {
                engine_of(*plan_.drone(answer.drone)).look_again(answer.drone);
                continue;
            }
            if (answer.status.state == State::starting)
                continue;
            require_same(plan_, *plan_.drone(answer.drone), answer);
            placed_.erase(answer.drone);
            waiting_.erase(answer.drone);
        } catch (const Error& error) {
            failed(answer.drone, error);  // another was faster
        }
}

void Starting::failed(std::string drone, const Error& error)
{
    waiting_.erase(drone);
    placed_.erase(drone);
    failures_.push_back({std::move(drone), error});
}

}  // namespace hive::swarm
