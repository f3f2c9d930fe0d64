// Calls of an application, and what their answers mean.
#include "orders.hpp"
#include "plan.hpp"

namespace hive::mixtures {
namespace {

Told told(const Error& error)
{
    switch (error.code()) {
    case Errc::refused:
    case Errc::invalid_argument:
    case Errc::not_found: return Told::refused;
    default: return Told::unknown;
    }
}

}  // namespace

Told set(Application& asking, const Change& change)
try {
    Json parameters{{"work_ms", change.work_ms}};
    if (change.most_ms)
        parameters["most_ms"] = *change.most_ms;
    auto result = Told::applied;
    for (const auto& answer : asking.set(change.drones, parameters).answers)
        if (const auto* error = error_of(answer.result); error && result != Told::unknown)
            result = told(*error);
    return result;
} catch (const Error& error) {
    return told(error);
}

Settings settings_of(Application& asking, const std::vector<std::string>& drones)
{
    Settings settings;
    for (const auto& answer : asking.get(drones))
        if (const auto* values = hive::value_of(answer.result);
            values && values->contains("work_ms") && answer.drone != watcher)
            settings[answer.drone] = {values->at("work_ms"), values->at("most_ms")};
    return settings;
}

}  // namespace hive::mixtures
