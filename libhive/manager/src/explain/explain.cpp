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
        if (error_of(answer.status) && !is_elsewhere(answer.place))
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
/// @param known  the answers are there already
Look look_again(const Look& before, const Ask& ask, bool known)
{
    Look look = before;
    std::vector<std::string> drones;
    for (const auto& answer : before.answers)
        if (const auto* error = error_of(answer.status); known || !error || error->code() == Errc::not_found)
            drones.push_back(answer.drone);
    for (auto& answer : ask(drones))
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
        const auto *before = value_of(earlier.find(drone)->status), *after = value_of(now.find(drone)->status);
        if (!before || !after || before->epoch != after->epoch)
            continue;
        const auto time = after->uptime_us - before->uptime_us;
        const auto taken = [&](const Status& status) {
            return processed(status, &InputStatus::processed) + processed(status, &InputStatus::abandoned);
        };
        Flow flow{.drone = drone,
                  .received_per_s = per_second(taken(*after) - taken(*before), time),
                  .emitted_per_s = per_second(emitted(*after) - emitted(*before), time)};
        for (const auto& input : after->inputs)
            flow.age_us = std::max(flow.age_us, input.last_age_us);
        flows.push_back(flow);
    }
    return flows;
}

/// These drones, and those that should be running.
std::vector<Endpoint> everything(Application& application, const std::vector<std::string>& drones)
{
    std::set<std::string> names(drones.begin(), drones.end());
    const auto remembered = application.remembered();
    names.insert(remembered.begin(), remembered.end());
    for (const auto& failed : application.failed())
        names.insert(failed.drone);
    std::vector<Endpoint> targets;
    for (const auto& name : names)
        targets.push_back({name, ""});
    return targets;
}

/// Gets the statuses of two looks.
struct Questions {
    Ask first, second;
    bool known = false;  ///< the second ones are there already
};

Questions ask_twice(Application& application) { return {status_by(application), status_by(application)}; }

/// Takes the answers from these lists, which must outlive it, the first that has the drone; queries the others, and
/// adds their answers to the last list.
Ask answered(Application& application, std::vector<std::vector<StatusAnswer>*> lists)
{
    return [&application, lists = std::move(lists)](const std::vector<std::string>& drones) {
        std::vector<StatusAnswer> answers(drones.size());
        std::vector<std::string> missing;
        std::vector<std::size_t> at;
        for (std::size_t i = 0; i < drones.size(); ++i) {
            const StatusAnswer* known = nullptr;
            for (const auto* list : lists)
                if (const auto found = std::ranges::find(*list, drones[i], &StatusAnswer::drone);
                    !known && found != list->end())
                    known = &*found;
            if (known) {
                answers[i] = *known;
            } else {
                missing.push_back(drones[i]);
                at.push_back(i);
            }
        }
        auto more = application.status(missing);
        for (std::size_t i = 0; i < more.size(); ++i)
            answers[at[i]] = lists.back()->emplace_back(std::move(more[i]));
        return answers;
    };
}

Explanation explanation(Application& application, const std::vector<std::string>& drones, const Walk& walk,
                        const Questions& questions)
{
    const auto first = look_from(application, drones, questions.first);
    for (const auto& answer : first.answers)
        if (const auto* error = error_of(answer.status);
            error && error->code() == Errc::invalid_argument && std::ranges::find(drones, answer.drone) != drones.end())
            throw *error;
    if (!questions.known)
        Inquiry(application).wait(event::Clock::now() + interval, {});
    const auto second = look_again(first, questions.second, questions.known);
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

Explanation explanation(Application& application, const std::vector<Endpoint>& targets, const Questions& questions)
{
    std::vector<std::string> drones;
    std::ranges::transform(targets, std::back_inserter(drones), &Endpoint::drone);
    return explanation(
        application, drones,
        [&](Search& search) {
            for (const auto& target : targets)
                search.target(target.drone, target.port);
        },
        questions);
}

}  // namespace

bool Explanation::has(Cause::What what) const { return std::ranges::find(causes, what, &Cause::what) != causes.end(); }

Explanation explain(Application& application, const std::vector<Endpoint>& ends)
{
    return explanation(application, ends.empty() ? everything(application, application.drones()) : ends,
                       ask_twice(application));
}

Explanation explain_answers(Application& application, std::vector<StatusAnswer> first, std::vector<StatusAnswer> second)
{
    std::vector<std::string> drones;
    std::ranges::transform(second, std::back_inserter(drones), &StatusAnswer::drone);
    // The first answer of a drone must not be newer than its second. The same answer twice shows no rate.
    return explanation(application, everything(application, drones),
                       {answered(application, {&first, &second}), answered(application, {&second}), true});
}

Explanation explain(Application& application, const Endpoint& sender, const Endpoint& receiver)
{
    auto result = explanation(
        application, std::vector{receiver.drone, sender.drone},
        [&](Search& search) { search.connection(sender, receiver); }, ask_twice(application));
    if (auto cause = unconnected_pair(application, sender, receiver)) {
        std::erase_if(result.causes, [](const Cause& other) { return other.what == Cause::What::not_connected; });
        result.causes.insert(result.causes.begin(), *std::move(cause));
    }
    return result;
}

}  // namespace hive
