// Detects a crashed drone by what it left: a state in the home, or a place in the list.
#include "staying.hpp"

#include "../directory.hpp"
#include "changes.hpp"
#include "differences.hpp"
#include "failed_drones.hpp"
#include "record.hpp"

#include <hive/event/home.hpp>
#include <hive/process.hpp>

#include <algorithm>
#include <csignal>
#include <utility>

namespace hive::swarm {

using namespace std::chrono_literals;

namespace {

constexpr auto first_pause = 100ms, longest_pause = 30'000ms;
constexpr auto steady_after = 60s;  ///< uptime after which its crashes no longer count as repeated
constexpr int crashes_shown = 6;    ///< number of crashes from which ps shows it as failed while it is not running
constexpr auto start_limit = 60s;
constexpr auto answer_limit = 5s;
constexpr auto hangs_after = 10s;  ///< without an answer
constexpr auto look_period = 100ms;

bool is_elsewhere(const Place& place) { return !place.address.empty() && !is_here(place); }

}  // namespace

RestartPause::Clock::time_point RestartPause::after_crash(Clock::time_point now)
{
    if (ready_at_ && now - *ready_at_ >= steady_after)
        crashes_ = 0;
    ready_at_.reset();
    auto pause = first_pause;
    for (int crash = 0; crash < crashes_ && pause < longest_pause; ++crash)
        pause = std::min(2 * pause, longest_pause);
    ++crashes_;
    return now + pause;
}

Staying::Staying(Application& application, SwarmPlan plan, std::function<void(const std::string& text)> told)
    : application_(application),
      record_(application.home(), plan.name),
      told_(std::move(told)),
      inquiry_(application, look_period)
{
    adopt(std::move(plan));
}

void Staying::adopt(SwarmPlan plan)
{
    plan_ = std::make_shared<const SwarmPlan>(std::move(plan));
    for (const auto& drone : plan_->drones)
        if (is_up(drone.name))
            cares_.try_emplace(drone.name);
    std::erase_if(cares_, [&](const auto& entry) { return !entry.second.starting && !is_up(entry.first); });
}

/// A swarm that was taken down has no record. The data about its drones stays valid until it is brought up again.
void Staying::read_record()
{
    auto text = record_.text();
    if (text == recorded_)
        return;
    auto plan = record_.read();
    is_up_ = !plan.drones.empty();
    if (is_up_)
        adopt(std::move(plan));
    recorded_ = std::move(text);
}

/// False if it was taken down, or if `down` could not stop it.
bool Staying::is_up(const std::string& drone) const
{
    const auto* const found = is_up_ ? plan_->drone(drone) : nullptr;
    return found && found->restart != Restart::never;
}

void Staying::look()
try {
    reap_background_processes();
    read_record();
    const auto remembered = application_.remembered();
    for (const auto& answer : inquiry_.take())
        hear(answer, remembered);
    follow_starts();
    start_due();
    if (!unsettled_.empty() && Clock::now() >= settle_at_)
        settle();
    if (!is_starting())
        claim_.reset();
} catch (const Error& error) {
    log_problem(error.what());
}

/// Drones being started are handled by follow_starts().
void Staying::wait()
{
    std::vector<std::string> names;
    for (const auto& [drone, care] : cares_)
        if (!care.starting)
            names.push_back(drone);
    inquiry_.ask(names, answer_limit);
    inquiry_.wait(Clock::now() + (is_starting() ? look_period / 10 : look_period), {});
}

bool Staying::is_starting() const
{
    return std::ranges::any_of(cares_, [](const auto& entry) { return entry.second.starting != nullptr; });
}

void Staying::hear(const StatusAnswer& answer, const std::vector<std::string>& remembered)
{
    const auto found = cares_.find(answer.drone);
    if (found == cares_.end())
        return;
    auto& care = found->second;
    const auto* error = error_of(answer.status);
    if (!error)
        care.shared = !owns(*plan_, answer);
    if (care.starting || care.shared)
        return;
    if (error && error->code() == Errc::timeout)
        return hear_silence(answer, care);
    care.silent_since.reset();
    if (!error) {
        care.missing_since.reset();
        care.restart_at.reset();
        care.begun = care.taken_down = false;
    } else if (!has_crashed(answer, care, remembered)) {
        care.restart_at.reset();
    } else if (!care.restart_at) {
        crashed(answer.drone, care);
    }
}

/// Kills a drone that hangs on this machine, which then counts as crashed.
void Staying::hear_silence(const StatusAnswer& answer, Care& care)
{
    const auto now = Clock::now();
    if (!care.silent_since)
        care.silent_since = now - answer_limit;
    const event::Home home(application_.home());
    const auto pid = home.holder(answer.drone);
    if (now - *care.silent_since < hangs_after || is_elsewhere(answer.place) || pid <= 0 || !home.alive(answer.drone))
        return;
    told_(answer.drone + " has not answered for " + std::to_string(hangs_after / 1s) + " s and is killed");
    ::kill(static_cast<pid_t>(pid), SIGKILL);
    care.silent_since.reset();
}

/// A drone stopped by a command has no saved state, and stays down unless the file says `always`. On this machine a
/// drone has its name until it has exited. Elsewhere a stop removes its place, but only after it has exited.
bool Staying::has_crashed(const StatusAnswer& answer, Care& care, const std::vector<std::string>& remembered) const
{
    const auto now = Clock::now();
    const auto* const planned = plan_->drone(answer.drone);
    if (!care.missing_since)
        care.missing_since = now;
    const bool may_be_ending = is_elsewhere(answer.place) ? now - *care.missing_since < 1s
                                                          : event::Home(application_.home()).alive(answer.drone);
    return !may_be_ending
           && (care.begun || is_elsewhere(answer.place)
               || std::ranges::find(remembered, answer.drone) != remembered.end()
               || (planned && planned->restart == Restart::always));
}

void Staying::crashed(const std::string& drone, Care& care)
{
    care.restart_at = care.pause.after_crash(Clock::now());
    if (care.pause.crashes() >= crashes_shown)
        FailedDrones(application_.home())
            .add({.drone = drone,
                  .reason = "crashed " + std::to_string(care.pause.crashes())
                            + " times in a row; it is restarted with pauses of up to "
                            + std::to_string(longest_pause / 1s) + " s",
                  .log = {}});
}

void Staying::follow_starts()
{
    for (auto& [drone, care] : cares_) {
        if (!care.starting)
            continue;
        const auto failures = care.starting->poll();
        if (failures.empty() && !care.starting->waiting().empty())
            continue;
        for (const auto& failure : failures) {
            static_cast<void>(care.starting->undo(Clock::now() + 2s));
            told_(drone + ": " + failure.error.what());
            crashed(drone, care);
        }
        if (failures.empty()) {
            care.pause.ready(Clock::now());
            unsettled_.insert(drone);
            settle_at_ = {};
            told_(drone + " crashed and was restarted");
        }
        care.starting.reset();
    }
    if (claim_ && claim_is_wanted(application_.home(), plan_->name))
        give_way();
}

/// Stops drones that are not ready, so that none becomes ready while the next process changes the swarm.
void Staying::give_way()
{
    for (auto& [drone, care] : cares_)
        if (care.starting && !care.starting->waiting().empty()) {
            told_(drone + ": not started now, because another process is changing the swarm");
            for (const auto& remains : care.starting->undo())
                told_(remains.drone + ": " + remains.error.what());
            care.starting.reset();
            care.restart_at = Clock::now();
        }
    claim_.reset();
}

/// With the claim: its previous owner may have started or stopped drones that seemed to have crashed.
void Staying::start_due()
{
    const auto now = Clock::now();
    const auto is_due = [now](const Care& care) {
        return !care.starting && care.restart_at && now >= *care.restart_at;
    };
    if (std::ranges::none_of(cares_, [&](const auto& entry) { return is_due(entry.second); }))
        return;
    if (!claim_)
        claim_ = claim_if_free(application_.home(), plan_->name);
    if (!claim_)
        return;
    read_record();
    for (auto& [drone, care] : cares_) {
        if (!is_due(care))
            continue;
        if (!is_up(drone)) {
            if (!std::exchange(care.taken_down, true))
                told_(drone + " was taken down, so it is not started again before it is brought up");
            care.restart_at = now + 1s;
            continue;
        }
        care.restart_at.reset();
        if (event::Home(application_.home()).alive(drone))
            continue;  // another process was faster
        care.begun = true;
        auto starting = std::make_unique<Starting>(application_, *plan_);
        starting->begin({drone}, start_limit);
        care.plan = plan_;
        care.starting = std::move(starting);
    }
}

/// With the claim, unless another process waits for it: the rest is restarted later.
void Staying::settle()
{
    const auto own = claim_ ? nullptr : claim_if_free(application_.home(), plan_->name);
    if (!claim_ && !own)
        return;
    read_record();
    std::erase_if(unsettled_, [&](const std::string& drone) { return !is_up(drone); });
    settle_at_ = Clock::now() + 1s;
    Changes changes(application_);
    const auto all = differences(application_, *plan_, *plan_);
    for (const auto& silent : all.silent)
        log_problem(silent.error.what());
    std::set<std::string> unsettled = all.silent.empty() ? std::set<std::string>() : unsettled_;
    for (const auto& step : all.steps) {
        if ((step.what != SwarmStep::What::set && step.what != SwarmStep::What::connect)
            || !unsettled_.contains(step.drone))
            continue;
        if (claim_is_wanted(application_.home(), plan_->name))
            return;
        for (const auto& failure : changes.make({&step, 1})) {
            unsettled.insert(failure.drone);
            log_problem(failure.drone + ": " + failure.error.what());
        }
    }
    unsettled_ = std::move(unsettled);
}

void Staying::log_problem(const std::string& text)
{
    if (std::exchange(trouble_, text) != text)
        told_(text);
}

}  // namespace hive::swarm
