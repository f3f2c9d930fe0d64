// Reads and writes the recorded plans of a home.
#include "record.hpp"

#include "present.hpp"

#include <hive/event/home.hpp>
#include <hive/name.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

namespace hive::swarm {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view ending = ".swarm";

std::string text_of(const fs::path& file)
{
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

SwarmPlan read_plan(const fs::path& file)
{
    auto reading = read_swarm(text_of(file));
    if (!reading.mistakes.empty())
        throw Error(Errc::malformed, "what " + file.string() + " remembers cannot be read: " + reading.mistakes[0].text,
                    "delete it; hivectl then no longer groups these drones");
    return std::move(reading.plan);
}

/// In a swarm file, an engine for a machine without drones is an error, so it is dropped.
void drop_unused_engines(SwarmPlan& plan)
{
    std::erase_if(plan.engines, [&](const auto& engine) {
        return std::ranges::none_of(plan.drones,
                                    [&](const SwarmDrone& drone) { return matches_glob(engine.first, drone.host); });
    });
}

}  // namespace

Record::Record(fs::path home, const std::string& swarm)
    : swarm_(swarm), file_(std::move(home) / (swarm + std::string(ending)))
{
}

std::string Record::text() const { return text_of(file_); }

SwarmPlan Record::read() const
{
    std::error_code ignored;
    return fs::exists(file_, ignored) ? read_plan(file_)
                                      : SwarmPlan{.name = swarm_, .drones = {}, .connections = {}, .engines = {}};
}

void Record::write(const SwarmPlan& plan) const { event::replace_file(file_, to_text(plan)); }

void Record::forget() const noexcept
{
    std::error_code ignored;
    fs::remove(file_, ignored);
}

std::vector<SwarmPlan> Record::all(const fs::path& home, const std::function<void(const Error&)>& unreadable)
{
    std::vector<SwarmPlan> plans;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(home, ignored))
        if (entry.path().extension() == ending)
            try {
                plans.push_back(read_plan(entry.path()));
            } catch (const Error& error) {
                if (!unreadable)
                    throw;
                unreadable(error);
            }
    std::ranges::sort(plans, {}, &SwarmPlan::name);
    return plans;
}

/// While a drone is being changed, it may still have its old kind and machine, and both plans matter for what a later
/// file must revert.
SwarmDrone as_either_says(SwarmDrone drone, const SwarmDrone& before)
{
    drone.host = before.host;
    drone.set.update(before.set);
    for (const auto& field : order_fields())
        if (field.is_given(before))
            field.copy(drone, before);
    return drone;
}

SwarmPlan with_rest_of(SwarmPlan plan, const SwarmPlan& before)
{
    for (auto& drone : plan.drones)
        if (const auto* old = before.drone(drone.name))
            drone = as_either_says(std::move(drone), *old);
    for (const auto& drone : before.drones)
        if (!plan.drone(drone.name))
            plan.drones.push_back({.name = drone.name, .kind = drone.kind, .host = drone.host});
    for (const auto& connection : before.connections)
        if (std::ranges::none_of(plan.connections,
                                 [&](const SwarmConnection& kept) { return same_ends(kept, connection); }))
            plan.connections.push_back(connection);
    for (const auto& engine : before.engines)
        if (std::ranges::none_of(plan.engines, [&](const auto& kept) { return kept.first == engine.first; }))
            plan.engines.push_back(engine);
    drop_unused_engines(plan);
    std::erase_if(plan.connections, [&](const SwarmConnection& connection) {
        return !plan.drone(connection.from.drone) || !plan.drone(connection.to.drone);
    });
    return plan;
}

SwarmPlan part_of(SwarmPlan plan, const std::vector<SwarmFailure>& remains, const std::vector<SwarmFailure>& silent)
{
    const auto is_left = [&](const std::string& drone) {
        return std::ranges::any_of(std::array{&remains, &silent}, [&](const auto* list) {
            return std::ranges::find(*list, drone, &SwarmFailure::drone) != list->end();
        });
    };
    std::erase_if(plan.drones, [&](const SwarmDrone& drone) { return !is_left(drone.name); });
    std::erase_if(plan.connections, [&](const SwarmConnection& connection) {
        return !is_left(connection.from.drone) && !is_left(connection.to.drone);
    });
    return plan;
}

SwarmPlan not_ended(SwarmPlan plan, const std::vector<SwarmFailure>& failures)
{
    const auto ended = [&](const std::string& drone) {
        return std::ranges::find(failures, drone, &SwarmFailure::drone) == failures.end();
    };
    std::erase_if(plan.drones, [&](const SwarmDrone& drone) { return ended(drone.name); });
    std::erase_if(plan.connections, [&](const SwarmConnection& connection) {
        return ended(connection.from.drone) || ended(connection.to.drone);
    });
    for (auto& drone : plan.drones)
        drone.restart = Restart::never;
    drop_unused_engines(plan);
    return plan;
}

}  // namespace hive::swarm
