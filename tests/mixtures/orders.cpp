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
        if (answer.error && result != Told::unknown)
            result = told(*answer.error);
    return result;
} catch (const Error& error) {
    return told(error);
}

Settings settings_of(Application& asking, const std::vector<std::string>& drones)
{
    Settings settings;
    for (const auto& answer : asking.get(drones))
        if (!answer.error && answer.result.contains("work_ms") && answer.drone != watcher)
            settings[answer.drone] = {answer.result.at("work_ms"), answer.result.at("most_ms")};
    return settings;
}

}  // namespace hive::mixtures
