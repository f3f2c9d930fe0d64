// Queries twice, keeps the causes found both times, and completes their commands.
#include "../inquiry.hpp"
#include "cures.hpp"
#include "machine_causes.hpp"
#include "search.hpp"

#include <algorithm>
#include <functional>

namespace hive {
namespace {

using namespace explaining;

constexpr std::chrono::milliseconds interval(300);

/// Filters the causes that concern the question.
using Walk = std::function<void(Search&)>;

bool same(const Cause& one, const Cause& other)
{
    return one.what == other.what && one.drone == other.drone && one.connection == other.connection;
}

/// Causes that block existing events come before those that prevent new ones.
int rank(const Cause& cause)
{
    using enum Cause::What;
    const bool idle = cause.what == not_connected || cause.what == no_receiver || cause.what == source_ended;
    return !cause.blocks ? 2 : idle ? 1 : 0;
}

std::vector<std::string> silent_here(const Look& look)
{
    std::vector<std::string> drones;
    for (const auto& answer : look.answers)
        if (answer.error && !is_elsewhere(answer.place))
            drones.push_back(answer.drone);
    return drones;
}

Absent absent_in(Application& application, const Look& look)
{
    Absent absent;
    const auto silent = silent_here(look);
    if (silent.empty())
        return absent;
    absent.crashed = application.crashed();
    absent.failed = application.failed();
    absent.add_machines(application);
    for (const auto& drone : silent)
        absent.add(application, drone);
    return absent;
}

/// Queries the drones once more, as one that was not running may have been started. Silent ones stay as they were, so
/// as not to wait for them twice.
Look look_again(Application& application, const Look& before)
{
    Look look = before;
    std::vector<std::string> drones;
    for (const auto& answer : before.answers)
        if (!answer.error || answer.error->code() == Errc::not_found)
            drones.push_back(answer.drone);
    for (auto& answer : application.status(drones))
        *std::ranges::find(look.answers, answer.drone, &StatusAnswer::drone) = std::move(answer);
    return look;
}

double per_second(std::int64_t count, std::int64_t us)
{
    return us > 0 ? static_cast<double>(count) * 1e6 / static_cast<double>(us) : 0;
}

std::vector<Flow> flows(const std::vector<std::string>& drones, const Look& earlier, const Look& now)
{
    std::vector<Flow> flows;
    for (const auto& drone : drones) {
        const auto &before = *earlier.find(drone), &after = *now.find(drone);
        if (before.error || after.error || before.status.epoch != after.status.epoch)
            continue;
        const auto time = after.status.uptime_us - before.status.uptime_us;
        const auto taken = [&](const Status& status) {
            return processed(status, &InputStatus::processed) + processed(status, &InputStatus::abandoned);
        };
        Flow flow{.drone = drone,
                  .received_per_s = per_second(taken(after.status) - taken(before.status), time),
                  .emitted_per_s = per_second(emitted(after.status) - emitted(before.status), time)};
        for (const auto& input : after.status.inputs)
            flow.age_us = std::max(flow.age_us, input.last_age_us);
        flows.push_back(flow);
    }
    return flows;
}

std::vector<Endpoint> everything(Application& application)
{
    std::set<std::string> names;
    for (const auto& drones : {application.drones(), application.remembered()})
        names.insert(drones.begin(), drones.end());
    for (const auto& failed : application.failed())
        names.insert(failed.drone);
    std::vector<Endpoint> targets;
    for (const auto& name : names)
        targets.push_back({name, ""});
    return targets;
}

Explanation explanation(Application& application, const std::vector<std::string>& drones, const Walk& walk)
{
    const auto first = look_from(application, drones);
    for (const auto& answer : first.answers)
        if (answer.error && answer.error->code() == Errc::invalid_argument
            && std::ranges::find(drones, answer.drone) != drones.end())
            throw *answer.error;
    Inquiry(application).wait(event::Clock::now() + interval, {});
    const auto second = look_again(application, first);
    const auto absent = absent_in(application, second);
    Search before(first, nullptr, absent, application.name()), after(second, &first, absent, application.name());
    walk(before);
    walk(after);
    Explanation result{.causes = after.causes(), .flows = flows(after.passed(), first, second)};
    std::erase_if(result.causes, [&](const Cause& cause) {
        using enum Cause::What;
        const bool compared = cause.what == throws || cause.what == stuck;  // with the first look
        return !compared
               && std::ranges::none_of(before.causes(), [&](const Cause& earlier) { return same(cause, earlier); });
    });
    for (auto& cause : same_names(second))
        result.causes.push_back(std::move(cause));
    for (auto& cause : machine_causes(first, second))
        result.causes.push_back(std::move(cause));
    std::ranges::stable_sort(result.causes, {}, rank);
    complete(application, result.causes);
    return result;
}

}  // namespace

bool Explanation::has(Cause::What what) const { return std::ranges::find(causes, what, &Cause::what) != causes.end(); }

Explanation explain(Application& application, const std::vector<Endpoint>& ends)
{
    const auto targets = ends.empty() ? everything(application) : ends;
    std::vector<std::string> drones;
    std::ranges::transform(targets, std::back_inserter(drones), &Endpoint::drone);
    return explanation(application, drones, [&](Search& search) {
        for (const auto& target : targets)
            search.target(target.drone, target.port);
    });
}

Explanation explain(Application& application, const Endpoint& sender, const Endpoint& receiver)
{
    auto result = explanation(application, {receiver.drone, sender.drone},
                              [&](Search& search) { search.connection(sender, receiver); });
    if (auto cause = unconnected_pair(application, sender, receiver)) {
        std::erase_if(result.causes, [](const Cause& other) { return other.what == Cause::What::not_connected; });
        result.causes.insert(result.causes.begin(), *std::move(cause));
    }
    return result;
}

}  // namespace hive
