// Brings a swarm up and takes it down.
#include <hive/swarm.hpp>

#include "inquiry.hpp"
#include "swarm/changes.hpp"
#include "swarm/claim.hpp"
#include "swarm/differences.hpp"
#include "swarm/ending.hpp"
#include "swarm/record.hpp"
#include "swarm/restarting.hpp"
#include "swarm/running_plan.hpp"
#include "swarm/starting.hpp"
#include "swarm/staying.hpp"

#include <hive/process.hpp>
#include <hive/program.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>

namespace hive {

using namespace std::chrono_literals;
using What = SwarmStep::What;

namespace {

SwarmOutcome interrupted(const std::string& swarm)
{
    return {.steps = {}, .failures = {{swarm, Error(Errc::stopped, "interrupted")}}, .remains = {}};
}

std::vector<std::string> drones_of(const std::vector<SwarmStep>& steps, What what)
{
    std::vector<std::string> names;
    for (const auto& step : steps)
        if (step.what == what)
            names.push_back(step.drone);
    return names;
}

bool is_cancelled(const SwarmWatch& watch) { return watch.cancelled && watch.cancelled(); }

void append(std::vector<SwarmFailure>& all, std::vector<SwarmFailure> more)
{
    std::ranges::move(more, std::back_inserter(all));
}

/// Connections that follow one another are made at once, up to as many as may be made before the caller can cancel.
/// @param busy  drones that do not apply their values in time, since their code hangs; the others go on
std::vector<SwarmFailure> change(swarm::Changes& changes, std::span<const SwarmStep> steps, const SwarmWatch& watch,
                                 std::vector<SwarmFailure>& busy)
{
    constexpr std::size_t max_at_once = 256;
    const auto all = steps.size();
    while (!steps.empty()) {
        if (is_cancelled(watch))
            return {{steps.front().drone, Error(Errc::stopped, "interrupted")}};
        const auto other = std::ranges::find_if_not(
            steps, [](What what) { return what == What::connect; }, &SwarmStep::what);
        const auto connections = static_cast<std::size_t>(other - steps.begin());
        const auto next = steps.first(std::clamp<std::size_t>(connections, 1, max_at_once));
        if (const auto what = next.front().what; what != What::start && what != What::restart && what != What::stop)
            if (auto failures = changes.make(next); !failures.empty()) {
                if (what != What::set || failures.front().error.code() != Errc::timeout)
                    return failures;
                append(busy, std::move(failures));
            }
        steps = steps.subspan(next.size());
        if (watch.on_progress)
            watch.on_progress(all - steps.size(), all, "wired");
    }
    return {};
}

/// Throws if a drone cannot be started from here, before anything is changed.
void require_engines(Application& application, const SwarmPlan& plan, const std::vector<SwarmStep>& steps)
{
    std::set<std::string> hosts;
    for (const auto& step : steps)
        if (step.what == What::start || step.what == What::restart)
            hosts.insert(plan.drone(step.drone)->host);
    for (const auto& host : hosts)
        make_engine(plan.engine_of(host), host, application.home())->require_usable();
}

bool starts_elsewhere(const SwarmPlan& plan, const std::vector<SwarmStep>& steps)
{
    return std::ranges::any_of(drones_of(steps, What::start),
                               [&](const std::string& drone) { return plan.drone(drone)->host != Place::here; });
}

/// A drone that is up may still lack its camera. Waits up to 2 s for that to pass, and reports what remains.
void report_conditions(Application& application, const std::vector<SwarmStep>& steps, const SwarmWatch& watch)
{
    using Clock = Inquiry::Clock;
    constexpr auto wait_time = 2s;
    constexpr auto pause = 50ms;
    std::set<std::string> waiting;
    for (const auto& step : steps)
        if (step.what == What::start || step.what == What::restart || step.what == What::set)
            waiting.insert(step.drone);
    std::map<std::string, std::string> conditions;
    Inquiry inquiry(application, pause);
    for (const auto end = Clock::now() + wait_time; !waiting.empty() && Clock::now() < end && !is_cancelled(watch);) {
        inquiry.ask({waiting.begin(), waiting.end()}, wait_time);
        inquiry.wait(std::min(end, Clock::now() + pause), {});
        for (const auto& answer : inquiry.take())
            if (const auto* status = value_of(answer.status);
                status && status->why == Reason::none && !status->condition.empty()) {
                conditions[answer.drone] = status->condition;
            } else {
                conditions.erase(answer.drone);
                waiting.erase(answer.drone);
            }
    }
    for (const auto& [drone, condition] : conditions)
        watch.told(drone + " reports: " + condition + "; see: hivectl explain " + drone);
}

bool is_empty(const SwarmPlan& plan) { return plan.drones.empty(); }

}  // namespace

std::string_view token(What what) noexcept
{
    constexpr std::array<std::string_view, 7> tokens{"start",   "restart",    "change", "set",
                                                     "connect", "disconnect", "stop"};
    return tokens[static_cast<std::size_t>(what)];
}

std::string to_text(const SwarmStep& step)
{
    if (step.what == What::connect || step.what == What::disconnect)
        return to_text(step.connection.from) + " -> " + to_text(step.connection.to);
    std::string text = step.drone;
    for (const auto& [name, value] : step.values.items())
        text += " " + assignment(name, value);
    return text;
}

Swarm::Swarm(Application& application, SwarmPlan plan) : application_(application), plan_(std::move(plan)) {}

std::vector<SwarmPlan> Swarm::remembered(Application& application, const std::function<void(const Error&)>& unreadable)
{
    return swarm::Record::all(application.home(), unreadable);
}

std::vector<SwarmStep> Swarm::differences(const SwarmWatch& watch)
{
    const auto differences =
        swarm::differences(application_, plan_, swarm::Record(application_.home(), plan_.name).read(), watch.told);
    for (const auto& [drone, error] : differences.silent)
        if (watch.told)
            watch.told(error.what() + ("; " + error.advice()));
    require_engines(application_, plan_, differences.steps);
    return differences.steps;
}

SwarmOutcome Swarm::up(std::chrono::milliseconds timeout, const SwarmWatch& watch)
{
    const auto alone = swarm::claim(application_, plan_.name, timeout, watch);
    if (!alone)
        return interrupted(plan_.name);
    const swarm::Record record(application_.home(), plan_.name);
    const auto before = record.read();
    const auto differences = swarm::differences(application_, plan_, before, watch.told);
    SwarmOutcome outcome{.steps = differences.steps, .failures = {}, .remains = {}, .silent = differences.silent};
    record.write(swarm::with_rest_of(plan_, before));  // if killed here, the next process finds what to clean up
    swarm::Starting starting(application_, plan_);
    swarm::Restarting restarting(application_, differences);
    swarm::Changes changes(application_);
    try {
        require_engines(application_, plan_, outcome.steps);
        outcome.failures = starting.run(drones_of(outcome.steps, What::start), timeout, watch);
        if (outcome.failures.empty())
            outcome.failures = restarting.run(timeout, watch);
    } catch (const Error& error) {
        outcome.failures = {{plan_.name, error}};
    }
    if (outcome.failures.empty())
        outcome.failures = change(changes, outcome.steps, watch, outcome.silent);
    std::erase_if(outcome.steps, [&](const SwarmStep& step) {
        return step.what == What::set
               && std::ranges::find(outcome.silent, step.drone, &SwarmFailure::drone) != outcome.silent.end();
    });
    if (!outcome.failures.empty()) {
        if (watch.told && (is_cancelled(watch) || starts_elsewhere(plan_, outcome.steps)))
            watch.told(std::string(is_cancelled(watch) ? "interrupted: " : "")
                       + "rolling back. Drones that are just being started on other machines are waited for "
                         "first");
        outcome.remains = changes.undo();
        append(outcome.remains, restarting.undo());
        append(outcome.remains, starting.undo());
    } else {
        outcome.remains = swarm::failures_in(application_.stop(drones_of(outcome.steps, What::stop), plan_.name));
    }
    if (!outcome.failures.empty() && !outcome.remains.empty())
        return outcome;
    const auto now = outcome.failures.empty()
                         ? swarm::with_rest_of(plan_, swarm::part_of(before, outcome.remains, outcome.silent))
                         : before;
    is_empty(now) ? record.forget() : record.write(now);
    if (watch.told && outcome.failures.empty())
        report_conditions(application_, outcome.steps, watch);
    return outcome;
}

SwarmOutcome Swarm::down(std::chrono::milliseconds timeout, const SwarmWatch& watch)
{
    const auto alone = swarm::claim(application_, plan_.name, timeout, watch);
    if (!alone)
        return interrupted(plan_.name);
    const swarm::Record record(application_.home(), plan_.name);
    const auto plan = swarm::with_rest_of(plan_, record.read());
    SwarmOutcome outcome = swarm::Ending(application_, plan).run(timeout, watch);
    reap_background_processes();
    const auto left = swarm::not_ended(plan, outcome.failures);
    is_empty(left) ? record.forget() : record.write(left);
    return outcome;
}

void Swarm::stay(const std::function<void(const std::string& text)>& told, const SwarmWatch& watch)
{
    for (swarm::Staying staying(application_, plan_, told); !is_cancelled(watch); staying.wait())
        staying.look();
}

SwarmPlan Swarm::running(Application& application, const std::string& name, const std::vector<std::string>& drones)
{
    return swarm::running_plan(application, name, drones);
}

}  // namespace hive
