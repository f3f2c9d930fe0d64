// Executes each step by a call of the application.
#include "changes.hpp"

#include <algorithm>
#include <iterator>

namespace hive::swarm {

using What = SwarmStep::What;

std::vector<SwarmFailure> Changes::make(std::span<const SwarmStep> steps)
{
    try {
        if (steps.front().what == What::connect)
            return connect(steps);
        make(steps.front());
        made_.push_back(steps.front());
        return {};
    } catch (const Error& error) {
        return {{steps.front().drone, error}};
    }
}

std::vector<SwarmFailure> Changes::connect(std::span<const SwarmStep> steps)
{
    std::vector<SwarmConnection> connections;
    std::ranges::transform(steps, std::back_inserter(connections), &SwarmStep::connection);
    const auto before = made_.size();
    made_.insert(made_.end(), steps.begin(), steps.end());  // if the caller cancels meanwhile, any may have been made
    const auto answers = application_.connect(connections);
    made_.resize(before);
    std::vector<SwarmFailure> failures;
    for (std::size_t i = 0; i < steps.size(); ++i)
        if (answers[i].error)
            failures.push_back({steps[i].drone, *answers[i].error});
        else
            made_.push_back(steps[i]);
    return failures;
}

void Changes::make(const SwarmStep& step)
{
    switch (step.what) {
    case What::set: application_.set(step.drone, step.values); break;
    case What::change: change(step.drone, step.values); break;
    case What::disconnect: application_.disconnect(step.connection.from, step.connection.to); break;
    case What::connect:
    case What::start:
    case What::restart:
    case What::stop: throw Error(Errc::invalid_argument, "drones are started and stopped by their engines");
    }
}

/// The fields of an order that a running drone can change.
void Changes::change(const std::string& drone, const Json& fields)
{
    for (const auto& [name, value] : fields.items())
        if (name == "on_exception")
            application_.exception_policy(drone, from_token<ExceptionPolicy>(value.get<std::string>(), name));
        else if (value.get<bool>())
            application_.halt(drone);
        else
            application_.resume(drone);
}

std::vector<SwarmFailure> Changes::undo()
{
    std::vector<SwarmFailure> remains;
    for (; !made_.empty(); made_.pop_back())
        try {
            undo(made_.back());
        } catch (const Error& error) {
            if (made_.back().what != What::connect || error.code() != Errc::not_found)  // else it was not made
                remains.push_back({made_.back().drone, error});
        }
    return remains;
}

void Changes::undo(const SwarmStep& step)
{
    const auto& [from, to, options] = step.connection;
    if (step.what == What::set)
        application_.set(step.drone, step.before);
    else if (step.what == What::change)
        change(step.drone, step.before);
    else if (step.what == What::disconnect)
        application_.connect(from, to, options);
    else if (step.replaced)
        application_.connect(from, to, *step.replaced);
    else
        application_.disconnect(from, to);
}

}  // namespace hive::swarm
